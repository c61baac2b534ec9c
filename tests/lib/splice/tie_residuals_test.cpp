// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/tie_residuals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dseam/base/random.hpp"

namespace dseam::splice {
namespace {

constexpr std::size_t kSide = 400;

// White noise, and its means over `wide` x `high` neighbours: the closed form of their correlation
// `lag` apart is 1 - lag / wide along a row and 1 - lag / high down a column.
std::vector<double> means_of_noise(std::size_t wide, std::size_t high) {
  Pcg32 random(7, 1);
  std::vector<double> noise((kSide + high) * (kSide + wide));
  for (double& value : noise) {
    value = random.uniform() - 0.5;
  }
  std::vector<double> means(kSide * kSide, 0.0);
  for (std::size_t k = 0; k < means.size(); ++k) {
    for (std::size_t j = 0; j < high; ++j) {
      for (std::size_t i = 0; i < wide; ++i) {
        means[k] += noise[(k / kSide + j) * (kSide + wide) + k % kSide + i];
      }
    }
  }
  return means;
}

// Every second line along a row, every second down a column.
TieResiduals residuals_of(const std::vector<double>& field) {
  TieResiduals residuals;
  for (std::size_t line = 0; line < kSide; ++line) {
    const bool down = line % 2 == 1;
    ResidualTrail trail;
    for (std::size_t step = 0; step < kSide; ++step) {
      const std::size_t k = down ? step * kSide + line : line * kSide + step;
      trail.push(field[k], true, down, residuals);
    }
  }
  return residuals;
}

TEST(TieResiduals, of_white_noise_each_counts) {
  const TieResiduals residuals = residuals_of(means_of_noise(1, 1));

  EXPECT_NEAR(residuals.variance_mm2(), 0.5 / 12.0, 0.001);
  EXPECT_NEAR(residuals.ties_per_independent(), 1.0, 0.05);
}

TEST(TieResiduals, of_means_over_three_by_two_one_in_six_counts) {
  const TieResiduals residuals = residuals_of(means_of_noise(3, 2));

  EXPECT_NEAR(residuals.ties_per_independent(), 6.0, 0.3);
}

TEST(TieResiduals, that_part_from_each_other_count_as_one_at_most) {
  TieResiduals residuals;
  ResidualTrail trail;
  for (int k = 0; k < 1000; ++k) {
    trail.push(k % 2 == 0 ? 1.0 : -1.0, true, false, residuals);
  }

  EXPECT_EQ(residuals.ties_per_independent(), 1.0);
}

TEST(TieResiduals, across_a_gap_have_nothing_in_common) {
  TieResiduals residuals;
  ResidualTrail trail;
  for (int k = 0; k < 40; ++k) {
    trail.push(1.0, k % 4 == 0, true, residuals);
  }

  EXPECT_EQ(residuals.ties_per_independent(), 1.0);
}

TEST(TieResiduals, none_at_all_are_no_noise) {
  EXPECT_EQ(TieResiduals{}.variance_mm2(), 0.0);
  EXPECT_EQ(TieResiduals{}.ties_per_independent(), 1.0);
}

TEST(Facing, a_steeper_sight_is_of_a_lower_class) {
  EXPECT_LT(facing_of(0.3), facing_of(0.6));
  EXPECT_LT(facing_of(0.6), facing_of(0.8));
  EXPECT_LT(facing_of(0.8), facing_of(1.0));
  EXPECT_LT(facing_of(1.0), kFacings);
}

}  // namespace
}  // namespace dseam::splice
