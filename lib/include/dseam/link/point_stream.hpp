// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "dseam/link/frame.hpp"
#include "dseam/link/messages.hpp"

namespace dseam::link {

/// The host's place in a trajectory: what was sent, acknowledged, confirmed and executed.
/// confirmed() <= acknowledged() <= next() holds always; going back means next() = acknowledged().
///
/// Memory:  none; the points stay the caller's.
class PointStream {
 public:
  /// `points` are valid: see encodable().
  void begin(trajectory::SetPointView points, std::uint32_t session,
             std::uint16_t trajectory) noexcept;
  /// Whether every point can be sent and their times rise strictly.
  [[nodiscard]] static bool encodable(trajectory::SetPointView points) noexcept;

  /// What the robot reports. True when it got further.
  bool on_status(const Status& status) noexcept;
  /// Sends again from the first point that is not acknowledged; returns how many that are.
  std::uint32_t go_back() noexcept;
  /// The robot asks for `expected_seq`; goes back to it, if that is a place to go back to.
  std::uint32_t on_nack(std::uint16_t expected_seq) noexcept;

  [[nodiscard]] TrajectoryMark announcement() const noexcept;
  /// The points up to acknowledged() or next().
  [[nodiscard]] TrajectoryMark mark_acknowledged() const noexcept { return mark(acknowledged_); }
  [[nodiscard]] TrajectoryMark mark_sent() const noexcept { return mark(next_); }
  /// The point at next(), as payload; may_send() must hold.
  [[nodiscard]] Frame point() const noexcept;
  /// The point at next() left: takes it into the CRC.
  void sent(const Frame& payload) noexcept;

  /// Whether the robot has room, and less than `window` points are under way.
  [[nodiscard]] bool may_send(std::uint32_t window) const noexcept {
    return next_.count < size() && next_.count - acknowledged_.count < std::min(credit_, window);
  }
  [[nodiscard]] std::uint32_t size() const noexcept {
    return static_cast<std::uint32_t>(points_.size());
  }
  [[nodiscard]] std::uint32_t next() const noexcept { return next_.count; }
  [[nodiscard]] std::uint32_t acknowledged() const noexcept { return acknowledged_.count; }
  [[nodiscard]] std::uint32_t confirmed() const noexcept { return confirmed_.count; }
  [[nodiscard]] std::uint32_t executed() const noexcept { return executed_; }
  [[nodiscard]] std::uint16_t trajectory() const noexcept { return trajectory_; }
  /// Points of the first `duration_ns`, at least `least`, at most all.
  [[nodiscard]] std::uint32_t count_within(std::int64_t duration_ns,
                                           std::uint32_t least) const noexcept;

 private:
  /// A place in the trajectory with the CRC-32 of all before it.
  struct Cursor {
    std::uint32_t count = 0;
    std::uint32_t crc = 0;
  };

  [[nodiscard]] Frame payload_of(std::uint32_t index) const noexcept;
  [[nodiscard]] Cursor moved(Cursor from, std::uint32_t to) const noexcept;
  [[nodiscard]] TrajectoryMark mark(const Cursor& at) const noexcept;

  trajectory::SetPointView points_;
  std::uint32_t session_ = 0;
  std::uint16_t trajectory_ = 0;
  Cursor next_;
  Cursor acknowledged_;
  Cursor confirmed_;
  std::uint32_t furthest_ = 0;  ///< Largest next_.count there was.
  std::uint32_t executed_ = 0;
  std::uint32_t credit_ = 0;
};

}  // namespace dseam::link
