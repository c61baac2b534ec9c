// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/unfollowed_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace dseam::seam {
namespace {

// A nozzle that is 0.03 mm too wide, 0.04 mm aside and 0.05 mm off in three lobes, each unknown.
ResidualModel::Row nozzle_errors(double phi_rad) {
  ResidualModel::Row errors{};
  errors[0] = 0.03;
  errors[1] = 0.04 * std::cos(phi_rad);
  errors[2] = 0.05 * std::sin(3.0 * phi_rad);
  return errors;
}

double variance_at(double phi_rad, std::size_t order) {
  constexpr int kPlaces = 64;
  UnfollowedError unfollowed;
  unfollowed.reset(order);
  for (int i = 0; i < kPlaces; ++i) {
    const double at = 2.0 * std::numbers::pi * i / kPlaces;
    unfollowed.add(at, nozzle_errors(at));
  }
  return unfollowed.variance_at(phi_rad, nozzle_errors(phi_rad));
}

TEST(UnfollowedError, of_a_constant_edge_is_all_but_the_width) {
  const double aside = 0.04 * std::cos(0.3);
  const double lobes = 0.05 * std::sin(0.9);

  EXPECT_NEAR(variance_at(0.3, 1), aside * aside + lobes * lobes, 1e-12);
}

TEST(UnfollowedError, of_an_edge_with_one_harmonic_is_the_lobes_alone) {
  const double lobes = 0.05 * std::sin(0.9);

  EXPECT_NEAR(variance_at(0.3, 3), lobes * lobes, 1e-12);
}

TEST(UnfollowedError, of_an_edge_with_as_many_harmonics_as_the_nozzle_is_none) {
  EXPECT_NEAR(variance_at(0.3, 7), 0.0, 1e-12);
}

}  // namespace
}  // namespace dseam::seam
