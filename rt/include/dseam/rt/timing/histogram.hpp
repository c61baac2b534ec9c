// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace dseam::rt {

/// Counts durations in buckets of 1 us, like `cyclictest -h`; longer ones fall into the last.
///
/// Context: one thread adds, any thread reads at any time, nobody waits. A reader may see one
///          duration's bucket before its maximum.
class Histogram {
 public:
  static constexpr std::size_t kBuckets = 4096;

  void add(std::int64_t duration_ns) noexcept;

  [[nodiscard]] std::uint32_t bucket(std::size_t us) const noexcept {
    return buckets_[us].load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t count() const noexcept;
  [[nodiscard]] std::int64_t max_ns() const noexcept {
    return max_ns_.load(std::memory_order_relaxed);
  }
  /// The least whole number of microseconds that `share` of all durations stay under.
  [[nodiscard]] std::uint32_t quantile_us(double share) const noexcept;

 private:
  std::array<std::atomic<std::uint32_t>, kBuckets> buckets_{};
  std::atomic<std::int64_t> max_ns_{0};
};

}  // namespace dseam::rt
