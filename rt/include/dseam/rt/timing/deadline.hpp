// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

namespace dseam::rt {

/// Tolerates single overruns of the cycle and trips on too many of the last 64.
///
/// Context: the cycle thread.
class OverrunMonitor {
 public:
  /// Trips at `most` overruns among the last `window` cycles (1 to 64).
  OverrunMonitor(unsigned most, unsigned window) noexcept
      : most_(most), mask_(window >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << window) - 1) {}

  void add(bool overran) noexcept {
    recent_ = ((recent_ << 1U) | (overran ? 1U : 0U)) & mask_;
    total_ += overran ? 1 : 0;
  }
  /// There were too many.
  [[nodiscard]] bool tripped() const noexcept {
    return static_cast<unsigned>(std::popcount(recent_)) >= most_;
  }
  void clear() noexcept { recent_ = 0; }
  [[nodiscard]] std::uint64_t total() const noexcept { return total_; }

 private:
  unsigned most_;
  std::uint64_t mask_;
  std::uint64_t recent_ = 0;
  std::uint64_t total_ = 0;
};

/// A sign of life from one thread, supervised by another.
///
/// Context: beat() from the watched thread, silent_ns() from the watching one; wait-free.
class Heartbeat {
 public:
  void beat(std::int64_t now_ns) noexcept { last_ns_.store(now_ns, std::memory_order_release); }
  [[nodiscard]] std::int64_t silent_ns(std::int64_t now_ns) const noexcept {
    return now_ns - last_ns_.load(std::memory_order_acquire);
  }

 private:
  std::atomic<std::int64_t> last_ns_{0};
};

}  // namespace dseam::rt
