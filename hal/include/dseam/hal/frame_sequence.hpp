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

  /// Takes the next frame's number. One that is behind or repeats counts as no progress.
  constexpr Step advance(std::uint64_t number) noexcept {
    const std::uint64_t place = (number - first_) % period_;
    const std::uint64_t ahead = any_ ? (place + period_ - place_) % period_ : 1;
    const bool forward = ahead != 0 && ahead <= period_ / 2;
    any_ = true;
    if (!forward) {
      return {sequence_, 0};
    }
    place_ = place;
    sequence_ += ahead;
    return {sequence_, static_cast<std::uint32_t>(ahead - 1)};
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
