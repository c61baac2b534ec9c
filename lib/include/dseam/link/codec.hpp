// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/base/result.hpp"
#include "dseam/link/frame.hpp"
#include "dseam/link/messages.hpp"

namespace dseam::link {

/// Fixed-point, little-endian payloads as weld-link.dbc describes them. encode() leaves the
/// identifier and the three bytes of the protection header at zero; `Transmitter` fills them.
///
/// Units:   micrometres, microseconds, 0.01 mm/s, 0.01 m/min, 0.01 V, 1/32767 of a quaternion.
/// Errors:  decode() gives kBadData for a wrong length or an enumerator that does not exist;
///          encode(Point) and encode(PoseReport) give kInvalidArgument for a value that is not
///          finite or does not fit.
[[nodiscard]] Frame encode(const Abort& message) noexcept;
[[nodiscard]] Frame encode(const Command& message) noexcept;
[[nodiscard]] Frame encode(const Status& message) noexcept;
[[nodiscard]] Frame encode(const TrajectoryMark& message) noexcept;
[[nodiscard]] Frame encode(const Nack& message) noexcept;
[[nodiscard]] Result<Frame> encode(const Point& message) noexcept;
[[nodiscard]] Result<Frame> encode(const PoseReport& message) noexcept;
[[nodiscard]] Frame encode(const Hello& message) noexcept;

[[nodiscard]] Result<Abort> decode_abort(const Frame& frame) noexcept;
[[nodiscard]] Result<Command> decode_command(const Frame& frame) noexcept;
[[nodiscard]] Result<Status> decode_status(const Frame& frame) noexcept;
[[nodiscard]] Result<TrajectoryMark> decode_trajectory(const Frame& frame) noexcept;
[[nodiscard]] Result<Nack> decode_nack(const Frame& frame) noexcept;
[[nodiscard]] Result<Point> decode_point(const Frame& frame) noexcept;
[[nodiscard]] Result<PoseReport> decode_pose(const Frame& frame) noexcept;
[[nodiscard]] Result<Hello> decode_hello(const Frame& frame) noexcept;

/// The part of a point frame that the trajectory's CRC-32 covers: all behind the header.
[[nodiscard]] std::span<const std::byte> covered_by_crc(const Frame& point) noexcept;

/// 1/32767: full scale of a quaternion's component.
inline constexpr double kQuaternionScale = 1.0 / 32767.0;

}  // namespace dseam::link
