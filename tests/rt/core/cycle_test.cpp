// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/cycle.hpp"

#include <gtest/gtest.h>

#include "dseam/base/random.hpp"
#include "dseam/hal/fake/manual_clock.hpp"

namespace {

using dseam::hal::fake::ManualClock;
using dseam::rt::Cycle;

constexpr std::int64_t kMs = 1'000'000;

TEST(Cycle, wakes_at_even_times_however_long_the_work_took) {
  ManualClock clock(123);
  Cycle cycle = Cycle::make({}, clock).value();
  dseam::Pcg32 random(1);
  for (int i = 1; i <= 3'600'000; i += 1) {  // An hour at 1 kHz.
    const Cycle::Tick tick = cycle.wait();
    ASSERT_EQ(tick.due_ns, 123 + i * kMs);
    ASSERT_EQ(tick.skipped, 0U);
    clock.advance(random.below(1'000'000));
  }

  EXPECT_EQ(cycle.skipped(), 0U);
}

TEST(Cycle, skips_what_it_missed_and_never_bursts) {
  ManualClock clock;
  Cycle cycle = Cycle::make({}, clock).value();
  (void)cycle.wait();
  clock.advance(3 * kMs + kMs / 2);

  const Cycle::Tick late = cycle.wait();
  const Cycle::Tick next = cycle.wait();

  EXPECT_EQ(late.skipped, 3U);
  EXPECT_EQ(late.due_ns, 5 * kMs);
  EXPECT_EQ(late.woke_ns, late.due_ns);
  EXPECT_FALSE(late.gap);
  EXPECT_EQ(next.due_ns, late.due_ns + kMs);
  EXPECT_EQ(cycle.skipped(), 3U);
}

TEST(Cycle, a_long_silence_of_the_clock_is_a_gap) {
  ManualClock clock;
  Cycle cycle = Cycle::make({}, clock).value();
  (void)cycle.wait();
  clock.advance(3600'000 * kMs);

  EXPECT_TRUE(cycle.wait().gap);
  EXPECT_FALSE(cycle.wait().gap);
}

/// Sleeps longer than asked once.
class Oversleeper final : public dseam::hal::Clock {
 private:
  std::int64_t do_now_ns() noexcept override { return now_ns_; }
  void do_sleep_until(std::int64_t deadline_ns) noexcept override {
    now_ns_ = deadline_ns + 60 * kMs;
  }
  std::int64_t now_ns_ = 0;
};

TEST(Cycle, oversleeping_is_a_gap_as_well) {
  Oversleeper clock;
  Cycle cycle = Cycle::make({}, clock).value();

  EXPECT_TRUE(cycle.wait().gap);
}

TEST(Cycle, periods_that_are_none_are_refused) {
  ManualClock clock;

  EXPECT_FALSE(Cycle::make({.period_ns = 0}, clock).ok());
  EXPECT_FALSE(Cycle::make({.period_ns = -kMs}, clock).ok());
  EXPECT_FALSE(Cycle::make({.period_ns = kMs, .gap_ns = 1}, clock).ok());
}

}  // namespace
