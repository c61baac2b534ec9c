// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/buffer.hpp"
#include "dseam/hal/can_bus.hpp"

namespace dseam::hal {

/// Frames that wait for the wire: the lowest identifier first, then the oldest. A full queue lets
/// a more urgent frame displace the least urgent one, and nothing leaves after its deadline.
///
/// Memory:  the lent slots.
/// Time:    O(slots).
class SendQueue {
 public:
  struct Slot {
    CanFrame frame;
    std::int64_t queued_ns = 0;
    std::int64_t deadline_ns = 0;
    std::uint64_t order = 0;
  };

  explicit SendQueue(std::span<Slot> slots) noexcept : waiting_(slots) {}

  /// False when the queue is full of frames at least as urgent.
  bool push(const CanFrame& frame, std::int64_t now_ns, std::int64_t deadline_ns) noexcept {
    if (waiting_.full()) {
      Slot& last = *std::ranges::max_element(waiting_.items(), before);
      if (last.frame.id <= frame.id) {
        ++dropped_;
        return false;
      }
      erase(last);
      ++dropped_;
    }
    return waiting_.append({frame, now_ns, deadline_ns, order_++});
  }
  /// The most urgent frame that was queued by `now_ns`; nullptr when there is none.
  [[nodiscard]] Slot* front(std::int64_t now_ns) noexcept {
    drop_late(now_ns);
    Slot* best = nullptr;
    for (Slot& slot : waiting_.items()) {
      if (slot.queued_ns <= now_ns && (best == nullptr || before(slot, *best))) {
        best = &slot;
      }
    }
    return best;
  }
  /// Takes `slot`, which front() returned, out.
  void erase(Slot& slot) noexcept {
    slot = waiting_[waiting_.size() - 1];
    waiting_.resize(waiting_.size() - 1);
  }
  void clear() noexcept {
    dropped_ += waiting_.size();
    waiting_.clear();
  }
  [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }
  /// When the frame that waits longest was queued.
  [[nodiscard]] std::optional<std::int64_t> oldest_ns() const noexcept {
    if (waiting_.empty()) {
      return std::nullopt;
    }
    return std::ranges::min_element(waiting_.view(), {}, &Slot::queued_ns)->queued_ns;
  }
  /// Frames that were accepted or offered, and never left.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  static bool before(const Slot& a, const Slot& b) noexcept {
    return a.frame.id != b.frame.id ? a.frame.id < b.frame.id : a.order < b.order;
  }
  void drop_late(std::int64_t now_ns) noexcept {
    for (std::size_t i = waiting_.size(); i-- > 0;) {
      if (waiting_[i].deadline_ns < now_ns) {
        erase(waiting_[i]);
        ++dropped_;
      }
    }
  }

  Buffer<Slot> waiting_;
  std::uint64_t order_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace dseam::hal
