// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/link/e2e.hpp"
#include "dseam/link/frame.hpp"

namespace dseam::link {

/// On a bus without FD a message of up to 64 bytes, already protected by profile 5, travels as
/// classic frames of 8 bytes: profile 22's header with the segment's number in the upper half of
/// byte 1, then 6 bytes of the message.
inline constexpr std::size_t kSegmentBytes = 6;
inline constexpr std::size_t kMaxSegments = 11;

[[nodiscard]] constexpr std::size_t segments_of(std::size_t message_bytes) noexcept {
  return (message_bytes + kSegmentBytes - 1) / kSegmentBytes;
}

/// Segment `index` of `whole`, unprotected.
[[nodiscard]] Frame segment_of(const Frame& whole, std::size_t index) noexcept;

/// Puts the segments of one message together again; a gap drops the message, never pads it.
class SegmentJoiner {
 public:
  enum class Progress : std::uint8_t { kIncomplete, kComplete, kDamaged };

  /// `message_bytes`: the length this message always has. Complete: whole() is the message.
  Progress add(const Frame& segment, const DataIdList& data_ids,
               std::size_t message_bytes) noexcept;
  [[nodiscard]] const Frame& whole() const noexcept { return whole_; }

 private:
  Frame whole_;
  CounterCheck counter_{16, 1};
  std::size_t next_ = 0;
};

}  // namespace dseam::link
