// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/hal/clock.hpp"

namespace dseam::rt {

/// CLOCK_MONOTONIC: steps of the wall clock do not touch it; it stands while the machine sleeps.
class MonotonicClock final : public hal::Clock {
 private:
  std::int64_t do_now_ns() noexcept override;
  void do_sleep_until(std::int64_t deadline_ns) noexcept override;
};

}  // namespace dseam::rt
