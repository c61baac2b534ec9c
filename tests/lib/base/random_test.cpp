// SPDX-License-Identifier: Apache-2.0
#include "dseam/base/random.hpp"

#include <gtest/gtest.h>

namespace dseam {
namespace {

TEST(Pcg32, gives_the_published_sequence_of_its_demo) {
  Pcg32 random(42, 54);

  // First values of pcg32-demo with seed 42 and stream 54, as its author prints them.
  EXPECT_EQ(random.next(), 0xa15c02b7U);
  EXPECT_EQ(random.next(), 0x7b47f409U);
  EXPECT_EQ(random.next(), 0xba1d3330U);
}

TEST(Pcg32, uniform_stays_in_its_interval_and_has_the_right_mean) {
  Pcg32 random(1);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double value = random.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
  }
  EXPECT_NEAR(sum / 100000.0, 0.5, 0.005);
}

}  // namespace
}  // namespace dseam
