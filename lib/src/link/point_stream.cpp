// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/point_stream.hpp"

#include <algorithm>

#include "dseam/link/codec.hpp"
#include "dseam/link/crc.hpp"

namespace dseam::link {
namespace {

/// The count nearest to `near` whose low 16 bits are `seq`, or -1 below zero.
std::int64_t unwrapped(std::uint16_t seq, std::uint32_t near) noexcept {
  const auto ahead =
      static_cast<std::int16_t>(static_cast<std::uint16_t>(seq - static_cast<std::uint16_t>(near)));
  return std::int64_t{near} + ahead;
}

}  // namespace

void PointStream::begin(trajectory::SetPointView points, std::uint32_t session,
                        std::uint16_t trajectory) noexcept {
  *this = PointStream();
  points_ = points;
  session_ = session;
  trajectory_ = trajectory;
}

bool PointStream::encodable(trajectory::SetPointView points) noexcept {
  std::int64_t before_us = -1;
  for (const trajectory::SetPoint& point : points) {
    Point message;
    message.set_point = point;
    if (!encode(message).ok() || point.t_us <= before_us) {
      return false;
    }
    before_us = point.t_us;
  }
  return true;
}

bool PointStream::on_status(const Status& status) noexcept {
  credit_ = status.credit;
  const std::int64_t confirmed = unwrapped(status.verified_seq, confirmed_.count);
  const std::int64_t acknowledged = unwrapped(status.ack_seq, acknowledged_.count);
  const std::int64_t executed = unwrapped(status.exec_seq, executed_);
  const bool sensible = confirmed >= confirmed_.count && confirmed <= acknowledged &&
                        acknowledged <= furthest_ && executed >= executed_ && executed <= confirmed;
  if (!sensible) {
    return false;
  }
  const bool further = confirmed > confirmed_.count || acknowledged > acknowledged_.count;
  executed_ = static_cast<std::uint32_t>(executed);
  confirmed_ = moved(confirmed_, static_cast<std::uint32_t>(confirmed));
  if (acknowledged < acknowledged_.count) {
    // The robot threw unconfirmed points away: all after the confirmed ones go again.
    acknowledged_ = confirmed_;
    next_ = confirmed_;
  }
  acknowledged_ = moved(acknowledged_, static_cast<std::uint32_t>(acknowledged));
  if (next_.count < acknowledged_.count) {
    next_ = acknowledged_;
  }
  return further;
}

std::uint32_t PointStream::go_back() noexcept {
  const std::uint32_t again = next_.count - acknowledged_.count;
  next_ = acknowledged_;
  return again;
}

std::uint32_t PointStream::on_nack(std::uint16_t expected_seq) noexcept {
  const std::int64_t expected = unwrapped(expected_seq, acknowledged_.count);
  if (expected < confirmed_.count || expected > next_.count) {
    return 0;
  }
  if (expected < acknowledged_.count) {
    acknowledged_ = confirmed_;
  }
  acknowledged_ = moved(acknowledged_, static_cast<std::uint32_t>(expected));
  return go_back();
}

TrajectoryMark PointStream::announcement() const noexcept {
  TrajectoryMark begin = mark({size(), 0});
  begin.kind = TrajectoryKind::kBegin;
  return begin;
}

TrajectoryMark PointStream::mark(const Cursor& at) const noexcept {
  TrajectoryMark mark;
  mark.kind = TrajectoryKind::kMark;
  mark.session = session_;
  mark.trajectory = trajectory_;
  mark.count = at.count;
  mark.crc = at.crc;
  mark.duration_us = points_.empty() ? 0 : points_.back().t_us;
  mark.length_mm = points_.empty() ? 0.0 : points_.back().s_mm;
  return mark;
}

Frame PointStream::payload_of(std::uint32_t index) const noexcept {
  Point message;
  message.session = session_;
  message.trajectory = trajectory_;
  message.seq = static_cast<std::uint16_t>(index);
  message.first = index == 0;
  message.last = index + 1 == size();
  message.set_point = points_[index];
  return encode(message).value();
}

Frame PointStream::point() const noexcept { return payload_of(next_.count); }

void PointStream::sent(const Frame& payload) noexcept {
  next_.crc = crc32(covered_by_crc(payload), next_.crc);
  ++next_.count;
  furthest_ = std::max(furthest_, next_.count);
}

PointStream::Cursor PointStream::moved(Cursor from, std::uint32_t to) const noexcept {
  if (to == next_.count) {
    return next_;
  }
  while (from.count < to) {
    from.crc = crc32(covered_by_crc(payload_of(from.count)), from.crc);
    ++from.count;
  }
  return from;
}

std::uint32_t PointStream::count_within(std::int64_t duration_ns,
                                        std::uint32_t least) const noexcept {
  std::uint32_t count = 0;
  while (count < size() &&
         (count < least || std::int64_t{points_[count].t_us} * 1000 <= duration_ns)) {
    ++count;
  }
  return count;
}

}  // namespace dseam::link
