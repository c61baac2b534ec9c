// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace dseam::rt {

/// Hands the newest value from one thread to another: newest wins, nothing is queued, neither side
/// waits. `tests/rt/model/latest_value.pml` is the same protocol, checked exhaustively.
///
/// The writer owns one of three slots, the reader another, and the third lies in between with a
/// mark that says whether it holds something new. write() and read() swap their own slot for it.
///
/// Context: one writing and one reading thread; wait-free.
template <typename T>
class LatestValue {
 public:
  static_assert(std::is_trivially_copyable_v<T>);

  void write(const T& value) noexcept {
    slots_[back_] = value;
    back_ = between_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// True when something was written since the last call; `out` is left alone otherwise.
  [[nodiscard]] bool read(T& out) noexcept {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) {
      return false;
    }
    front_ = between_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    out = slots_[front_];
    return true;
  }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  static constexpr std::size_t kCacheLine = 64;

  std::array<T, 3> slots_{};
  alignas(kCacheLine) std::uint8_t back_ = 0;
  alignas(kCacheLine) std::uint8_t front_ = 1;
  alignas(kCacheLine) std::atomic<std::uint8_t> between_{2};
};

}  // namespace dseam::rt
