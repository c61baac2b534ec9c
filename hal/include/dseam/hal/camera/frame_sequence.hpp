// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::hal {

/// A device's wrapping frame numbers made into a sequence that only rises, and the gaps in it.
class FrameSequence {
 public:
  /// Frame numbers are `first`, ..., `last`, then `first` again. GigE Vision: 1 to 65535.
  /// V4L2: 0 to 2^32 - 1.
  constexpr FrameSequence(std::uint64_t first, std::uint64_t last) noexcept
      : first_(first), period_(last - first + 1) {}

  struct Step {
    std::uint64_t sequence = 0;
    std::uint32_t gap = 0;  ///< Numbers left out since the frame before.
  };

  /// Takes the next frame's number. One that repeats, or is a few behind, is a frame like another
  /// and no gap (some drivers number by the clock); one that is far behind means that the device
  /// began to count anew.
  constexpr Step advance(std::uint64_t number) noexcept {
    constexpr std::uint64_t kReordered = 16;
    const std::uint64_t place = (number - first_) % period_;
    const std::uint64_t ahead = any_ ? (place + period_ - place_) % period_ : 1;
    if (any_ && (ahead == 0 || period_ - ahead <= kReordered)) {
      return {++sequence_, 0};
    }
    const bool anew = ahead > period_ / 2;
    any_ = true;
    place_ = place;
    sequence_ += anew ? 1 : ahead;
    return {sequence_, anew ? 0 : static_cast<std::uint32_t>(ahead - 1)};
  }

  [[nodiscard]] constexpr std::uint64_t current() const noexcept { return sequence_; }
  /// The device turned out to count further than was said.
  constexpr void widen(std::uint64_t last) noexcept {
    period_ = last - first_ + 1 > period_ ? last - first_ + 1 : period_;
  }
  /// After a reconnect the device counts from anywhere; the sequence goes on with no gap.
  constexpr void restart() noexcept { any_ = false; }

 private:
  std::uint64_t first_;
  std::uint64_t period_;
  std::uint64_t place_ = 0;
  std::uint64_t sequence_ = 0;
  bool any_ = false;
};

}  // namespace dseam::hal
