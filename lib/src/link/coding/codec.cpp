// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/codec.hpp"

#include "fields.hpp"

namespace dseam::link {
namespace {

constexpr std::size_t kHeaderBytes = 3;

constexpr Frame frame_of(std::uint8_t size_bytes, bool fd = true) noexcept {
  Frame frame;
  frame.fd = fd;
  frame.size_bytes = size_bytes;
  return frame;
}

/// Enumerators are numbered from 0; what lies beyond the last one is damage.
template <typename Enum>
bool get_enum(unsigned value, unsigned count, Enum& out) noexcept {
  if (value >= count) {
    return false;
  }
  out = static_cast<Enum>(value);
  return true;
}

/// An enumerator in the low half and a flag in bit 4; a reserved bit that is set is damage too.
template <typename Enum>
bool get_with_bit4(const Frame& frame, std::size_t at, unsigned count, Enum& low,
                   bool& bit) noexcept {
  const unsigned byte = get<std::uint8_t>(frame, at);
  bit = (byte & 0x10U) != 0;
  return (byte & 0xE0U) == 0 && get_enum(byte & 0x0FU, count, low);
}

template <typename Enum>
std::uint8_t with_bit4(Enum low, bool bit) noexcept {
  return static_cast<std::uint8_t>(static_cast<unsigned>(low) | (bit ? 0x10U : 0U));
}

constexpr unsigned kEnabled = 1U;
constexpr unsigned kProtectiveStop = 2U;
constexpr unsigned kEmergencyStop = 4U;
constexpr unsigned kConditionBits = kEnabled | kProtectiveStop | kEmergencyStop;

std::uint8_t bits_of(const RobotCondition& condition) noexcept {
  return static_cast<std::uint8_t>((condition.enabled ? kEnabled : 0U) |
                                   (condition.protective_stop ? kProtectiveStop : 0U) |
                                   (condition.emergency_stop ? kEmergencyStop : 0U));
}

/// A reserved bit that is set is damage here as well.
bool get_condition(unsigned bits, RobotCondition& out) noexcept {
  out = {(bits & kEnabled) != 0, (bits & kProtectiveStop) != 0, (bits & kEmergencyStop) != 0};
  return (bits & ~kConditionBits) == 0;
}

}  // namespace

Frame encode(const Abort& message) noexcept {
  Frame frame = frame_of(8, false);
  put(frame, 2, static_cast<std::uint8_t>(message.reason));
  put(frame, 4, message.session);
  return frame;
}

Result<Abort> decode_abort(const Frame& frame) noexcept {
  Abort message;
  if (frame.size_bytes != 8 ||
      !get_enum(get<std::uint8_t>(frame, 2), kFaultCount, message.reason)) {
    return Errc::kBadData;
  }
  message.session = get<std::uint32_t>(frame, 4);
  return message;
}

Frame encode(const Command& message) noexcept {
  Frame frame = frame_of(16);
  put(frame, 3, with_bit4(message.request, message.weld_permit));
  put(frame, 4, message.trajectory);
  put(frame, 6, message.session);
  put(frame, 10, message.host_time_us, kTimeBytes);
  return frame;
}

Result<Command> decode_command(const Frame& frame) noexcept {
  Command message;
  if (frame.size_bytes != 16 ||
      !get_with_bit4(frame, 3, kRequestCount, message.request, message.weld_permit)) {
    return Errc::kBadData;
  }
  message.trajectory = get<std::uint16_t>(frame, 4);
  message.session = get<std::uint32_t>(frame, 6);
  message.host_time_us = get<std::uint64_t>(frame, 10, kTimeBytes);
  return message;
}

Frame encode(const Status& message) noexcept {
  Frame frame = frame_of(32);
  put(frame, 3, with_bit4(message.state, message.arc_on));
  put(frame, 4, message.ack_seq);
  put(frame, 6, message.exec_seq);
  put(frame, 8, message.credit);
  put(frame, 10, message.buffer_ms);
  put(frame, 12, message.trajectory);
  put(frame, 14, static_cast<std::uint16_t>(message.fault));
  put(frame, 16, message.robot_time_us, kTimeBytes);
  put(frame, 22, message.session);
  put(frame, 26, message.verified_seq);
  put(frame, 28, bits_of(message.condition));
  return frame;
}

Result<Status> decode_status(const Frame& frame) noexcept {
  Status message;
  if (frame.size_bytes != 32 ||
      !get_with_bit4(frame, 3, kRobotStateCount, message.state, message.arc_on) ||
      !get_enum(get<std::uint16_t>(frame, 14), kFaultCount, message.fault) ||
      !get_condition(get<std::uint8_t>(frame, 28), message.condition)) {
    return Errc::kBadData;
  }
  message.ack_seq = get<std::uint16_t>(frame, 4);
  message.exec_seq = get<std::uint16_t>(frame, 6);
  message.credit = get<std::uint16_t>(frame, 8);
  message.buffer_ms = get<std::uint16_t>(frame, 10);
  message.trajectory = get<std::uint16_t>(frame, 12);
  message.robot_time_us = get<std::uint64_t>(frame, 16, kTimeBytes);
  message.session = get<std::uint32_t>(frame, 22);
  message.verified_seq = get<std::uint16_t>(frame, 26);
  return message;
}

Frame encode(const TrajectoryMark& message) noexcept {
  Frame frame = frame_of(32);
  put(frame, 3, static_cast<std::uint8_t>(message.kind));
  put(frame, 4, message.trajectory);
  put(frame, 6, message.session);
  put(frame, 10, message.count);
  put(frame, 14, message.crc);
  put(frame, 18, message.duration_us);
  // Information only: a length that does not fit travels as 0.
  static_cast<void>(put_scaled<std::uint32_t>(frame, 22, message.length_mm, 0.001));
  return frame;
}

Result<TrajectoryMark> decode_trajectory(const Frame& frame) noexcept {
  TrajectoryMark message;
  if (frame.size_bytes != 32 ||
      !get_enum(get<std::uint8_t>(frame, 3), kTrajectoryKindCount, message.kind)) {
    return Errc::kBadData;
  }
  message.trajectory = get<std::uint16_t>(frame, 4);
  message.session = get<std::uint32_t>(frame, 6);
  message.count = get<std::uint32_t>(frame, 10);
  message.crc = get<std::uint32_t>(frame, 14);
  message.duration_us = get<std::uint32_t>(frame, 18);
  message.length_mm = get_scaled<std::uint32_t>(frame, 22, 0.001);
  return message;
}

Frame encode(const Nack& message) noexcept {
  Frame frame = frame_of(12);
  put(frame, 3, static_cast<std::uint8_t>(message.reason));
  put(frame, 4, message.trajectory);
  put(frame, 6, message.expected_seq);
  put(frame, 8, message.session);
  return frame;
}

Result<Nack> decode_nack(const Frame& frame) noexcept {
  Nack message;
  if (frame.size_bytes != 12 ||
      !get_enum(get<std::uint8_t>(frame, 3), kNackReasonCount, message.reason)) {
    return Errc::kBadData;
  }
  message.trajectory = get<std::uint16_t>(frame, 4);
  message.expected_seq = get<std::uint16_t>(frame, 6);
  message.session = get<std::uint32_t>(frame, 8);
  return message;
}

Frame encode(const Hello& message) noexcept {
  Frame frame = frame_of(32);
  put(frame, 3, message.version);
  put(frame, 4, message.session);
  put(frame, 8, message.dictionary_crc);
  put(frame, 12, message.buffer_points);
  put(frame, 14, message.min_period_us);
  // A faster robot than 655 mm/s travels as 0: no limit.
  static_cast<void>(put_scaled<std::uint16_t>(frame, 16, message.max_speed_mm_s, 0.01));
  put(frame, 18, message.silence_limit_ms);
  return frame;
}

Result<Hello> decode_hello(const Frame& frame) noexcept {
  if (frame.size_bytes != 32) {
    return Errc::kBadData;
  }
  Hello message;
  message.version = get<std::uint8_t>(frame, 3);
  message.session = get<std::uint32_t>(frame, 4);
  message.dictionary_crc = get<std::uint32_t>(frame, 8);
  message.buffer_points = get<std::uint16_t>(frame, 12);
  message.min_period_us = get<std::uint16_t>(frame, 14);
  message.max_speed_mm_s = get_scaled<std::uint16_t>(frame, 16, 0.01);
  message.silence_limit_ms = get<std::uint8_t>(frame, 18);
  return message;
}

std::span<const std::byte> covered_by_crc(const Frame& point) noexcept {
  return point.bytes().subspan(kHeaderBytes);
}

}  // namespace dseam::link
