// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "dseam/link/frame.hpp"
#include "dseam/link/messages.hpp"

namespace dseam::link {

/// The robot's ring of points: received in order, confirmed by marks, executed in order.
/// executed() <= verified() <= received() <= executed() + capacity() holds always.
///
/// Memory:  the lent slots.
class PointStore {
 public:
  struct Slot {
    trajectory::SetPoint point;
    std::uint32_t crc = 0;  ///< CRC-32 of the trajectory up to and with this point.
  };
  enum class Take : std::uint8_t { kStored, kRepeated, kGap, kNoRoom, kContradiction, kBadMark };
  enum class Confirm : std::uint8_t { kConfirmed, kWaiting, kNothingNew, kMismatch };

  explicit PointStore(std::span<Slot> slots) noexcept : slots_(slots) {}

  /// Forgets everything; `total` points will come.
  void begin(std::uint32_t total) noexcept;
  /// Stores `point` when it is the next one. kContradiction: its time does not rise, or it is one
  /// point too many. kBadMark: the mark that waited for it did not fit.
  Take take(const Point& point, const Frame& frame) noexcept;
  /// A mark is more urgent on the bus than the points it covers: one that came first waits for
  /// them. A mismatch throws away every point that is not confirmed.
  Confirm confirm(std::uint32_t count, std::uint32_t crc) noexcept;
  /// The next point to execute, or nullptr when no confirmed one is left.
  [[nodiscard]] const trajectory::SetPoint* front() const noexcept;
  void pop() noexcept { ++executed_; }
  /// Time of the last confirmed point; 0 when there is none.
  [[nodiscard]] std::uint32_t verified_until_us() const noexcept { return verified_until_us_; }

  [[nodiscard]] std::uint32_t total() const noexcept { return total_; }
  [[nodiscard]] std::uint32_t received() const noexcept { return received_; }
  [[nodiscard]] std::uint32_t verified() const noexcept { return verified_; }
  [[nodiscard]] std::uint32_t executed() const noexcept { return executed_; }
  [[nodiscard]] std::uint32_t capacity() const noexcept {
    return static_cast<std::uint32_t>(slots_.size());
  }
  [[nodiscard]] std::uint32_t free() const noexcept { return capacity() - (received_ - executed_); }
  [[nodiscard]] bool complete() const noexcept { return total_ > 0 && executed_ == total_; }

 private:
  [[nodiscard]] Slot& slot(std::uint32_t index) const noexcept {
    return slots_[index % slots_.size()];
  }

  std::span<Slot> slots_;
  std::uint32_t total_ = 0;
  std::uint32_t received_ = 0;
  std::uint32_t verified_ = 0;
  std::uint32_t executed_ = 0;
  std::uint32_t received_crc_ = 0;
  std::uint32_t verified_crc_ = 0;
  std::uint32_t received_until_us_ = 0;
  std::uint32_t verified_until_us_ = 0;
  std::uint32_t waiting_count_ = 0;  ///< Of the newest mark that came before its points.
  std::uint32_t waiting_crc_ = 0;
};

}  // namespace dseam::link
