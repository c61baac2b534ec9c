// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "dseam/hal/clock.hpp"

namespace dseam::hal::fake {

/// Virtual time: it passes when somebody sleeps, or is told to.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(std::int64_t start_ns = 0) noexcept : now_ns_(start_ns) {}
  void advance(std::int64_t by_ns) noexcept { now_ns_ += by_ns; }

 private:
  std::int64_t do_now_ns() noexcept override { return now_ns_; }
  void do_sleep_until(std::int64_t deadline_ns) noexcept override {
    std::int64_t now_ns = now_ns_;
    while (now_ns < deadline_ns && !now_ns_.compare_exchange_weak(now_ns, deadline_ns)) {
    }
  }

  std::atomic<std::int64_t> now_ns_;
};

}  // namespace dseam::hal::fake
