// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/timing/deadline.hpp"

#include <gtest/gtest.h>

#include "dseam/rt/timing/histogram.hpp"

namespace {

using dseam::rt::Heartbeat;
using dseam::rt::Histogram;
using dseam::rt::OverrunMonitor;

bool trips_after(OverrunMonitor& monitor, bool overran) {
  monitor.add(overran);
  return monitor.tripped();
}

TEST(OverrunMonitor, bears_one_and_trips_on_too_many_of_the_last) {
  OverrunMonitor monitor(3, 10);

  EXPECT_FALSE(trips_after(monitor, true));
  EXPECT_FALSE(trips_after(monitor, false));
  EXPECT_FALSE(trips_after(monitor, true));
  EXPECT_TRUE(trips_after(monitor, true));
  EXPECT_EQ(monitor.total(), 3U);
}

TEST(OverrunMonitor, forgets_what_lies_before_its_window) {
  OverrunMonitor monitor(2, 4);
  monitor.add(true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(trips_after(monitor, false));
  }

  EXPECT_FALSE(trips_after(monitor, true));
  EXPECT_TRUE(trips_after(monitor, true));
  monitor.clear();
  EXPECT_FALSE(trips_after(monitor, true));
}

TEST(OverrunMonitor, the_widest_window_is_sixty_four) {
  OverrunMonitor monitor(2, 64);
  monitor.add(true);
  for (int i = 0; i < 62; ++i) {
    EXPECT_FALSE(trips_after(monitor, false));
  }

  EXPECT_TRUE(trips_after(monitor, true));
}

TEST(Heartbeat, tells_how_long_a_thread_has_been_silent) {
  Heartbeat heart;
  heart.beat(1000);

  EXPECT_EQ(heart.silent_ns(4000), 3000);
}

TEST(Histogram, sorts_durations_by_microsecond_and_keeps_the_longest) {
  Histogram histogram;
  for (int us = 0; us < 100; ++us) {
    histogram.add(us * 1000 + 500);
  }
  histogram.add(1'000'000'000);
  histogram.add(-5);

  EXPECT_EQ(histogram.count(), 102U);
  EXPECT_EQ(histogram.bucket(0), 2U);
  EXPECT_EQ(histogram.bucket(Histogram::kBuckets - 1), 1U);
  EXPECT_EQ(histogram.max_ns(), 1'000'000'000);
  EXPECT_EQ(histogram.quantile_us(0.5), 50U);
  EXPECT_EQ(histogram.quantile_us(1.0), Histogram::kBuckets);
  EXPECT_EQ(histogram.quantile_us(2.0), Histogram::kBuckets);
}

}  // namespace
