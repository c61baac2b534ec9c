// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/robust.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "dseam/base/random.hpp"

namespace {

using dseam::geometry::tukey;
using dseam::geometry::tukey_cut_mm;

/// Nearly normal, of sigma 1: the sum of twelve uniform numbers.
double noise(dseam::Pcg32& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) {
    sum += random.uniform();
  }
  return sum;
}

TEST(Robust, a_weight_falls_from_one_to_nothing_at_the_cut_and_stays_there) {
  EXPECT_EQ(tukey(0.0), 1.0);
  EXPECT_NEAR(tukey(0.5), 0.5625, 1e-12);
  EXPECT_EQ(tukey(-0.5), tukey(0.5));
  EXPECT_EQ(tukey(1.0), 0.0);
  EXPECT_EQ(tukey(7.0), 0.0);
}

TEST(Robust, the_cut_is_4_685_sigma_of_the_noise_though_a_third_of_the_points_lies_far_off) {
  dseam::Pcg32 random(1);
  constexpr double kSigmaMm = 0.2;
  std::vector<float> clean;
  for (int i = 0; i < 20'000; ++i) {
    clean.push_back(static_cast<float>(std::abs(kSigmaMm * noise(random))));
  }
  std::vector<float> soiled = clean;
  soiled.insert(soiled.end(), 10'000, 50.0F);

  const double of_clean = tukey_cut_mm(clean);
  const double of_soiled = tukey_cut_mm(soiled);

  EXPECT_NEAR(of_clean, 4.685 * kSigmaMm, 0.03);
  // Half of all are then three quarters of the clean ones: 1.150 sigma in place of 0.6745.
  EXPECT_NEAR(of_soiled / of_clean, 1.150 / 0.6745, 0.03);
}

TEST(Robust, points_without_noise_leave_a_cut_above_zero) {
  std::array<float, 3> exact{};

  EXPECT_GT(tukey_cut_mm(exact), 0.0);
}

}  // namespace
