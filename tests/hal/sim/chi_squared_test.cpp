// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/chi_squared.hpp"

#include <gtest/gtest.h>

namespace dseam::test {
namespace {

TEST(ChiSquared, quantiles_are_those_of_the_tables) {
  EXPECT_NEAR(chi_squared_quantile(0.95, 1), 3.841459, 1e-5);
  EXPECT_NEAR(chi_squared_quantile(0.95, 6), 12.591587, 1e-5);
  EXPECT_NEAR(chi_squared_quantile(0.50, 2), 1.386294, 1e-5);
  EXPECT_NEAR(chi_squared_quantile(0.99, 30), 50.892181, 1e-5);
}

TEST(NeesTally, a_covariance_that_is_no_covariance_counts_as_outside) {
  NeesTally tally;

  tally.add(geometry::Vector6::Ones(), geometry::Matrix6::Zero());

  EXPECT_EQ(tally.share_inside(), 0.0);
  EXPECT_FALSE(tally.passes());
}

TEST(NeesTally, too_small_and_too_large_sigmas_both_fail) {
  NeesTally overconfident;
  NeesTally timid;
  for (int i = 0; i < 100; ++i) {
    overconfident.add(i < 80 ? 1.0 : 9.0, 1);
    timid.add(0.01, 1);
  }

  EXPECT_FALSE(overconfident.passes());
  EXPECT_FALSE(timid.passes());
}

}  // namespace
}  // namespace dseam::test
