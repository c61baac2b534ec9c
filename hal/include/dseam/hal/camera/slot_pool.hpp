// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>

#include "dseam/base/expects.hpp"

namespace dseam::hal {

/// Which of a camera's buffers are free: what every frame lease takes from and gives back to.
///
/// Context: take() from one thread, give_back() from any; both lock-free.
class SlotPool {
 public:
  static constexpr std::uint32_t kMaxSlots = 32;
  static constexpr std::uint32_t kNone = kMaxSlots;

  explicit SlotPool(std::uint32_t slots) noexcept : slots_(slots), free_(mask_of(slots)) {
    DSEAM_EXPECTS(slots <= kMaxSlots);
  }

  /// A free slot, or kNone.
  [[nodiscard]] std::uint32_t take() noexcept {
    std::uint32_t free = free_.load(std::memory_order_relaxed);
    while (free != 0) {
      const std::uint32_t lowest = free & (~free + 1U);
      if (free_.compare_exchange_weak(free, free ^ lowest, std::memory_order_acquire)) {
        return static_cast<std::uint32_t>(std::countr_zero(lowest));
      }
    }
    return kNone;
  }
  void give_back(std::uint32_t slot) noexcept {
    DSEAM_EXPECTS(slot < slots_);
    free_.fetch_or(1U << slot, std::memory_order_release);
  }
  [[nodiscard]] std::uint32_t num_slots() const noexcept { return slots_; }
  [[nodiscard]] std::uint32_t num_lent() const noexcept {
    return slots_ - static_cast<std::uint32_t>(std::popcount(free_.load()));
  }

 private:
  static std::uint32_t mask_of(std::uint32_t slots) noexcept {
    return slots == kMaxSlots ? ~0U : (1U << slots) - 1U;
  }

  std::uint32_t slots_;
  std::atomic<std::uint32_t> free_;
};

}  // namespace dseam::hal
