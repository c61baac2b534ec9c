// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "dseam/rt/cycle.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"
#include "dseam/rt/linux/thread_setup.hpp"
#include "dseam/rt/timing/histogram.hpp"
#include "support/allocation_counter.hpp"

namespace {

// No latency is asserted: the machine that runs the tests promises none.
TEST(RealCycle, keeps_its_phase_on_the_monotonic_clock) {
  dseam::rt::MonotonicClock clock;
  dseam::rt::Cycle cycle = dseam::rt::Cycle::make({}, clock).value();
  dseam::rt::Histogram wake_up;
  const std::int64_t first_ns = cycle.wait().due_ns;
  const dseam::test::AllocationCounter counter;
  std::int64_t last_ns = first_ns;

  for (int i = 0; i < 300; ++i) {
    const auto tick = cycle.wait();
    wake_up.add(tick.woke_ns - tick.due_ns);
    EXPECT_GE(tick.woke_ns, tick.due_ns);
    EXPECT_EQ((tick.due_ns - first_ns) % 1'000'000, 0);
    EXPECT_GT(tick.due_ns, last_ns);
    last_ns = tick.due_ns;
  }

  EXPECT_EQ(counter.count(), 0U);
  EXPECT_EQ(wake_up.count(), 300U);
}

}  // namespace
