// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dseam/link/channel.hpp"
#include "dseam/link/codec.hpp"

namespace dseam::link {
constexpr std::size_t kBurstBits = 16;

/// Bits in the order in which they are on the wire: most significant first within a byte.
inline void flip_on_wire(Frame& frame, std::size_t bit) {
  frame.data[bit / 8] ^= static_cast<std::byte>(0x80U >> (bit % 8));
}

inline Frame burst(Frame frame, std::size_t start, std::uint32_t pattern) {
  for (std::size_t i = 0; i < kBurstBits; ++i) {
    if (((pattern >> i) & 1U) != 0) {
      flip_on_wire(frame, start + i);
    }
  }
  return frame;
}

/// What each single flip adds to the CRC; the CRC is linear. `protect` puts the right one in.
template <typename Protect>
std::vector<std::uint32_t> syndromes_of(const Frame& clean, const Protect& protect) {
  std::vector<std::uint32_t> syndromes;
  for (std::size_t bit = 0; bit < clean.size_bytes * 8U; ++bit) {
    Frame damaged = clean;
    flip_on_wire(damaged, bit);
    Frame right = damaged;
    protect(right);
    syndromes.push_back(std::to_integer<std::uint32_t>(damaged.data[0] ^ right.data[0]) |
                        (std::to_integer<std::uint32_t>(damaged.data[1] ^ right.data[1]) << 8U));
  }
  return syndromes;
}

/// Every burst of up to 16 bits that fulfils the CRC of this frame.
template <typename Protect>
std::vector<std::pair<std::size_t, std::uint32_t>> missed_by_crc(const Frame& clean,
                                                                 const Protect& protect) {
  const std::vector<std::uint32_t> s = syndromes_of(clean, protect);
  std::vector<std::pair<std::size_t, std::uint32_t>> missed;
  for (std::size_t start = 0; start < s.size(); ++start) {
    std::vector<std::uint32_t> sum(1U << kBurstBits, 0);
    const std::size_t bits = std::min(kBurstBits, s.size() - start);
    for (std::uint32_t pattern = 1; pattern < (1U << bits); ++pattern) {
      const auto lowest = static_cast<std::size_t>(std::countr_zero(pattern));
      sum[pattern] = sum[pattern & (pattern - 1)] ^ s[start + lowest];
      if ((pattern & 1U) != 0 && sum[pattern] == 0) {
        missed.emplace_back(start, pattern);
      }
    }
  }
  return missed;
}

inline Frame payload_of(MessageId message) {
  switch (message) {
    case MessageId::kCommand:
      return encode(Command{9, Request::kStart, true, 3, 123456});
    case MessageId::kTrajectory:
      return encode(TrajectoryMark{9, TrajectoryKind::kMark, 3, 64, 0x12345678, 1000, 5.0});
    case MessageId::kNack:
      return encode(Nack{9, 3, 17, NackReason::kGap});
    case MessageId::kPoint:
      return encode(Point{9, 3, 5, false, false, {}}).value();
    case MessageId::kPose:
      return encode(PoseReport{9, 5, {}, 1.0, 7, true}).value();
    case MessageId::kHelloHost:
    case MessageId::kHelloRobot:
      return encode(Hello{9, kProtocolVersion, 1, 2, 3, 20, 5.0});
    default:
      return encode(Status{
          9, RobotState::kRunning, true, 6, 5, 4, 3, 2, 1, Fault::kNone, 8, {.enabled = true}});
  }
}

inline bool decodes(const Accepted& accepted) {
  switch (accepted.message) {
    case MessageId::kCommand:
      return decode_command(accepted.payload).ok();
    case MessageId::kStatus:
      return decode_status(accepted.payload).ok();
    case MessageId::kTrajectory:
      return decode_trajectory(accepted.payload).ok();
    case MessageId::kNack:
      return decode_nack(accepted.payload).ok();
    case MessageId::kPose:
      return decode_pose(accepted.payload).ok();
    case MessageId::kPoint:
      return decode_point(accepted.payload).ok();
    default:
      return decode_hello(accepted.payload).ok() &&
             decode_hello(accepted.payload).value().version == kProtocolVersion;
  }
}

}  // namespace dseam::link
