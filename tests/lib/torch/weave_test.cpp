// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/weave.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using dseam::torch::is_valid;
using dseam::torch::offset_at;
using dseam::torch::Weave;
using dseam::torch::WeaveShape;

const WeaveShape kShapes[] = {WeaveShape::kSine, WeaveShape::kZigZag, WeaveShape::kTriangle,
                              WeaveShape::kCircle};

TEST(Weave, each_shape_reaches_its_amplitude_on_both_sides_and_returns_after_a_pitch) {
  for (const WeaveShape shape : kShapes) {
    const Weave weave{shape, 2.0, 5.0};
    double left = 0.0;
    double right = 0.0;
    for (double s = 0.0; s < 50.0; s += 0.01) {
      const auto a = offset_at(weave, s);
      const auto b = offset_at(weave, s + 5.0);
      left = std::max(left, a.across_mm);
      right = std::min(right, a.across_mm);
      EXPECT_NEAR(a.across_mm, b.across_mm, 1e-9);
      EXPECT_NEAR(a.out_mm, b.out_mm, 1e-9);
      EXPECT_NEAR(a.along_mm, b.along_mm, 1e-9);
    }
    EXPECT_NEAR(left, 2.0, 1e-2);
    EXPECT_NEAR(right, -2.0, 1e-2);
    EXPECT_NEAR(offset_at(weave, 0.0).across_mm, 0.0, 1e-12);
  }
}

TEST(Weave, is_continuous_for_every_shape_with_and_without_dwells) {
  for (const WeaveShape shape : kShapes) {
    for (const double dwell : {0.0, 1.0}) {
      const Weave weave{shape, 2.0, 5.0, dwell, dwell / 2.0, 1.0};
      auto before = offset_at(weave, 0.0);
      for (double s = 0.001; s < 20.0; s += 0.001) {
        const auto now = offset_at(weave, s);
        EXPECT_LT(std::abs(now.across_mm - before.across_mm), 0.02);
        EXPECT_LT(std::abs(now.out_mm - before.out_mm), 0.02);
        EXPECT_LT(std::abs(now.along_mm - before.along_mm), 0.02);
        before = now;
      }
    }
  }
}

TEST(Weave, dwells_hold_the_side_for_their_length) {
  const Weave weave{WeaveShape::kZigZag, 2.0, 6.0, 1.0, 0.5};
  double left_mm = 0.0;
  double right_mm = 0.0;
  for (double s = 0.0; s < 6.0; s += 0.001) {
    left_mm += offset_at(weave, s).across_mm > 1.9999 ? 0.001 : 0.0;
    right_mm += offset_at(weave, s).across_mm < -1.9999 ? 0.001 : 0.0;
  }

  EXPECT_NEAR(left_mm, 1.0, 0.01);
  EXPECT_NEAR(right_mm, 0.5, 0.01);
}

TEST(Weave, no_shape_is_no_motion) {
  EXPECT_EQ(offset_at({}, 3.0).across_mm, 0.0);
  EXPECT_TRUE(is_valid(Weave{}));
}

TEST(Weave, times_become_lengths_of_travel) {
  const Weave weave = dseam::torch::weave_from_times(WeaveShape::kSine, 2.0, 2.0, 0.1, 0.2, 8.0);

  EXPECT_DOUBLE_EQ(weave.pitch_mm, 4.0 + 0.8 + 1.6);
  EXPECT_DOUBLE_EQ(weave.dwell_left_mm, 0.8);
  EXPECT_DOUBLE_EQ(weave.dwell_right_mm, 1.6);
  EXPECT_TRUE(is_valid(weave));
}

TEST(Weave, values_that_make_no_weave_are_invalid) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  EXPECT_FALSE(is_valid({WeaveShape::kSine, 1.0, 0.0}));
  EXPECT_FALSE(is_valid({WeaveShape::kSine, kNan, 5.0}));
  EXPECT_FALSE(is_valid({WeaveShape::kSine, -1.0, 5.0}));
  EXPECT_FALSE(is_valid({WeaveShape::kSine, 1.0, 5.0, 4.0, 0.5}));
  EXPECT_FALSE(is_valid({WeaveShape::kSine, 1.0, 5.0, kNan}));
  EXPECT_FALSE(is_valid({static_cast<WeaveShape>(9), 1.0, 5.0}));
  EXPECT_FALSE(is_valid(dseam::torch::weave_from_times(WeaveShape::kSine, 1.0, 0.0, 0, 0, 8.0)));
}

}  // namespace
