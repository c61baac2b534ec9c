// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::hal {

/// Monotonic time. Injected, so that the whole runtime also runs under virtual time.
///
/// Units:   nanoseconds since an arbitrary start; never set back, never a wall clock.
/// Context: any thread, real-time safe.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

  [[nodiscard]] std::int64_t now_ns() noexcept { return do_now_ns(); }
  /// Returns at `deadline_ns` or at once when that has passed.
  void sleep_until(std::int64_t deadline_ns) noexcept { do_sleep_until(deadline_ns); }

 protected:
  ~Clock() = default;  // Owners hold the concrete type: no delete, so no heap, through a base.

 private:
  virtual std::int64_t do_now_ns() noexcept = 0;
  virtual void do_sleep_until(std::int64_t deadline_ns) noexcept = 0;
};

}  // namespace dseam::hal
