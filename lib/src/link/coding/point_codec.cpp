// SPDX-License-Identifier: Apache-2.0
// The two messages that carry a pose.
#include "dseam/link/codec.hpp"
#include "fields.hpp"

namespace dseam::link {
namespace {

constexpr std::uint8_t kPoseSizeBytes = 48;
constexpr unsigned kFirst = 0x01;
constexpr unsigned kLast = 0x02;
constexpr unsigned kArc = 0x04;
constexpr unsigned kGas = 0x08;
constexpr unsigned kWire = 0x10;
constexpr unsigned kSegmentShift = 5;
constexpr unsigned kSegmentCount = 7;

constexpr double kPositionScale = 0.001;
constexpr double kProcessScale = 0.01;

/// Position in bytes 12 to 23, quaternion (w, x, y, z) in bytes 24 to 31 of both messages.
bool put_pose(Frame& frame, const torch::TorchPose& pose) noexcept {
  const Eigen::Quaterniond& q = pose.q_base_torch;
  return put_scaled<std::int32_t>(frame, 12, pose.p_base.x(), kPositionScale) &&
         put_scaled<std::int32_t>(frame, 16, pose.p_base.y(), kPositionScale) &&
         put_scaled<std::int32_t>(frame, 20, pose.p_base.z(), kPositionScale) &&
         put_scaled<std::int16_t>(frame, 24, q.w(), kQuaternionScale) &&
         put_scaled<std::int16_t>(frame, 26, q.x(), kQuaternionScale) &&
         put_scaled<std::int16_t>(frame, 28, q.y(), kQuaternionScale) &&
         put_scaled<std::int16_t>(frame, 30, q.z(), kQuaternionScale);
}

bool get_pose(const Frame& frame, torch::TorchPose& pose) noexcept {
  pose.p_base = {get_scaled<std::int32_t>(frame, 12, kPositionScale),
                 get_scaled<std::int32_t>(frame, 16, kPositionScale),
                 get_scaled<std::int32_t>(frame, 20, kPositionScale)};
  Eigen::Quaterniond q(get_scaled<std::int16_t>(frame, 24, kQuaternionScale),
                       get_scaled<std::int16_t>(frame, 26, kQuaternionScale),
                       get_scaled<std::int16_t>(frame, 28, kQuaternionScale),
                       get_scaled<std::int16_t>(frame, 30, kQuaternionScale));
  const double norm = q.norm();
  if (!(norm > 0.99 && norm < 1.01)) {
    return false;  // Four rounded components of a rotation are never this far from 1.
  }
  q.coeffs() /= norm;
  pose.q_base_torch = q;
  return true;
}

unsigned flags_of(const Point& message) noexcept {
  const trajectory::SetPoint& point = message.set_point;
  return (message.first ? kFirst : 0U) | (message.last ? kLast : 0U) | (point.arc ? kArc : 0U) |
         (point.gas ? kGas : 0U) | (point.wire ? kWire : 0U) |
         (static_cast<unsigned>(point.segment) << kSegmentShift);
}

bool set_flags(unsigned flags, Point& message) noexcept {
  const unsigned segment = flags >> kSegmentShift;
  if (segment >= kSegmentCount) {
    return false;
  }
  message.first = (flags & kFirst) != 0;
  message.last = (flags & kLast) != 0;
  message.set_point.arc = (flags & kArc) != 0;
  message.set_point.gas = (flags & kGas) != 0;
  message.set_point.wire = (flags & kWire) != 0;
  message.set_point.segment = static_cast<torch::Segment>(segment);
  return true;
}

Frame pose_frame() noexcept {
  Frame frame;
  frame.fd = true;
  frame.size_bytes = kPoseSizeBytes;
  return frame;
}

}  // namespace

Result<Frame> encode(const Point& message) noexcept {
  const trajectory::SetPoint& point = message.set_point;
  Frame frame = pose_frame();
  put(frame, 3, static_cast<std::uint8_t>(flags_of(message)));
  put(frame, 4, message.trajectory);
  put(frame, 6, message.seq);
  put(frame, 8, point.t_us);
  put(frame, 38, point.schedule);
  put(frame, 39, point.pass);
  put(frame, 44, message.session);
  const bool fits = put_pose(frame, point.pose) &&
                    put_scaled<std::uint16_t>(frame, 32, point.speed_mm_s, kProcessScale) &&
                    put_scaled<std::uint16_t>(frame, 34, point.wire_feed_m_min, kProcessScale) &&
                    put_scaled<std::uint16_t>(frame, 36, point.voltage_v, kProcessScale) &&
                    put_scaled<std::uint32_t>(frame, 40, point.s_mm, kPositionScale);
  return fits ? Result<Frame>(frame) : Errc::kInvalidArgument;
}

Result<Point> decode_point(const Frame& frame) noexcept {
  Point message;
  if (frame.size_bytes != kPoseSizeBytes || !set_flags(get<std::uint8_t>(frame, 3), message) ||
      !get_pose(frame, message.set_point.pose)) {
    return Errc::kBadData;
  }
  message.trajectory = get<std::uint16_t>(frame, 4);
  message.seq = get<std::uint16_t>(frame, 6);
  message.session = get<std::uint32_t>(frame, 44);
  trajectory::SetPoint& point = message.set_point;
  point.t_us = get<std::uint32_t>(frame, 8);
  point.speed_mm_s = get_scaled<std::uint16_t>(frame, 32, kProcessScale);
  point.wire_feed_m_min = get_scaled<std::uint16_t>(frame, 34, kProcessScale);
  point.voltage_v = get_scaled<std::uint16_t>(frame, 36, kProcessScale);
  point.schedule = get<std::uint8_t>(frame, 38);
  point.pass = get<std::uint8_t>(frame, 39);
  point.s_mm = get_scaled<std::uint32_t>(frame, 40, kPositionScale);
  return message;
}

Result<Frame> encode(const PoseReport& message) noexcept {
  Frame frame = pose_frame();
  put(frame, 3, static_cast<std::uint8_t>(message.arc_on ? 1 : 0));
  put(frame, 4, message.robot_time_us, kTimeBytes);
  put(frame, 10, message.exec_seq);
  put(frame, 34, message.session);
  const bool fits = put_pose(frame, message.pose) &&
                    put_scaled<std::uint16_t>(frame, 32, message.speed_mm_s, kProcessScale);
  return fits ? Result<Frame>(frame) : Errc::kInvalidArgument;
}

Result<PoseReport> decode_pose(const Frame& frame) noexcept {
  PoseReport message;
  const unsigned arc = get<std::uint8_t>(frame, 3);
  if (frame.size_bytes != kPoseSizeBytes || arc > 1 || !get_pose(frame, message.pose)) {
    return Errc::kBadData;
  }
  message.arc_on = arc != 0;
  message.robot_time_us = get<std::uint64_t>(frame, 4, kTimeBytes);
  message.exec_seq = get<std::uint16_t>(frame, 10);
  message.speed_mm_s = get_scaled<std::uint16_t>(frame, 32, kProcessScale);
  message.session = get<std::uint32_t>(frame, 34);
  return message;
}

}  // namespace dseam::link
