// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/classic.hpp"

#include <algorithm>

namespace dseam::link {
namespace {

constexpr std::size_t kSegmentHeader = 2;

std::size_t number_of(const Frame& segment) noexcept {
  return std::to_integer<std::size_t>(segment.data[1]) >> 4U;
}

/// Bytes of the message in segment `index`; the last one may be shorter.
std::size_t bytes_in(std::size_t message_bytes, std::size_t index) noexcept {
  const std::size_t at = index * kSegmentBytes;
  return at >= message_bytes ? 0 : std::min(kSegmentBytes, message_bytes - at);
}

}  // namespace

Frame segment_of(const Frame& whole, std::size_t index) noexcept {
  Frame segment;
  const std::size_t bytes = bytes_in(whole.size_bytes, index);
  segment.id = whole.id;
  segment.size_bytes = static_cast<std::uint8_t>(kSegmentHeader + bytes);
  segment.data[1] = static_cast<std::byte>((index & 0x0FU) << 4U);
  std::copy_n(whole.data.begin() + static_cast<std::ptrdiff_t>(index * kSegmentBytes), bytes,
              segment.data.begin() + kSegmentHeader);
  return segment;
}

SegmentJoiner::Progress SegmentJoiner::add(const Frame& segment, const DataIdList& data_ids,
                                           std::size_t message_bytes) noexcept {
  const E2eStatus status =
      counter_.check(intact_p22(segment.bytes(), data_ids), counter_p22(segment.bytes()));
  if (status == E2eStatus::kRepeated) {
    return Progress::kIncomplete;
  }
  const std::size_t index = number_of(segment);
  const std::size_t bytes = bytes_in(message_bytes, index);
  const bool first = index == 0;
  const bool in_order = first || (status == E2eStatus::kOk && index == next_);
  if (status == E2eStatus::kError || !in_order || segment.size_bytes != kSegmentHeader + bytes) {
    // Only damage is reported: what follows a gap is silently dropped until the next message.
    next_ = kMaxSegments;
    return status == E2eStatus::kError ? Progress::kDamaged : Progress::kIncomplete;
  }
  std::copy_n(segment.data.begin() + kSegmentHeader, bytes,
              whole_.data.begin() + static_cast<std::ptrdiff_t>(index * kSegmentBytes));
  next_ = index + 1;
  if (next_ < segments_of(message_bytes)) {
    return Progress::kIncomplete;
  }
  whole_.id = segment.id;
  whole_.fd = true;
  whole_.size_bytes = static_cast<std::uint8_t>(message_bytes);
  return Progress::kComplete;
}

}  // namespace dseam::link
