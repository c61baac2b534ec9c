// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/monotonic_clock.hpp"

#include <cerrno>
#include <ctime>

namespace dseam::rt {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

}  // namespace

std::int64_t MonotonicClock::do_now_ns() noexcept {
  timespec now{};
  (void)clock_gettime(CLOCK_MONOTONIC, &now);  // Cannot fail for this clock.
  return std::int64_t{now.tv_sec} * kNsPerS + now.tv_nsec;
}

void MonotonicClock::do_sleep_until(std::int64_t deadline_ns) noexcept {
  const timespec deadline{deadline_ns / kNsPerS, deadline_ns % kNsPerS};
  // A signal wakes early; the time is absolute, so sleeping on needs no arithmetic.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

}  // namespace dseam::rt
