// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>

namespace dseam::rt {

/// Hands every value from one thread to another, in order. A full queue refuses and counts.
///
/// Memory:  room for `kCapacity` values, in the object.
/// Context: one pushing and one popping thread; wait-free.
template <typename T, std::size_t kCapacity>
class Queue {
 public:
  [[nodiscard]] bool push(const T& value) noexcept {
    if (queue_.push(value)) {
      return true;
    }
    refused_.store(refused_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return false;
  }
  [[nodiscard]] bool pop(T& out) noexcept { return queue_.pop(out); }
  /// Values that found no room; any thread may ask.
  [[nodiscard]] std::uint64_t refused() const noexcept {
    return refused_.load(std::memory_order_relaxed);
  }

 private:
  boost::lockfree::spsc_queue<T, boost::lockfree::capacity<kCapacity>> queue_;
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace dseam::rt
