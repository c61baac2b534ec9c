// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/timing/histogram.hpp"

#include <algorithm>

namespace dseam::rt {

void Histogram::add(std::int64_t duration_ns) noexcept {
  const std::int64_t us = std::clamp<std::int64_t>(duration_ns / 1000, 0, kBuckets - 1);
  std::atomic<std::uint32_t>& bucket = buckets_[static_cast<std::size_t>(us)];
  // One writer: no read-modify-write is needed, and none is paid for.
  bucket.store(bucket.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  if (duration_ns > max_ns_.load(std::memory_order_relaxed)) {
    max_ns_.store(duration_ns, std::memory_order_relaxed);
  }
}

std::uint64_t Histogram::count() const noexcept {
  std::uint64_t sum = 0;
  for (const auto& bucket : buckets_) {
    sum += bucket.load(std::memory_order_relaxed);
  }
  return sum;
}

std::uint32_t Histogram::quantile_us(double share) const noexcept {
  const double wanted = share * static_cast<double>(count());
  std::uint64_t sum = 0;
  for (std::size_t us = 0; us < kBuckets; ++us) {
    sum += bucket(us);
    if (static_cast<double>(sum) >= wanted) {
      return static_cast<std::uint32_t>(us) + 1;
    }
  }
  return kBuckets;
}

}  // namespace dseam::rt
