// SPDX-License-Identifier: Apache-2.0
#include "dseam/trajectory/sampler.hpp"

#include <algorithm>
#include <cmath>

#include "stretch.hpp"

namespace dseam::trajectory {

Result<Sampler> Sampler::make(const TimedPathView& timed, const WeldTable& table,
                              std::uint32_t period_us) noexcept {
  if (period_us == 0 || timed.path.size() < 2 || timed.nodes.size() < 2 ||
      !(timed.window_s >= 0.0)) {
    return Errc::kInvalidArgument;
  }
  return Sampler(timed, table, period_us);
}

Sampler::Sampler(const TimedPathView& timed, const WeldTable& table,
                 std::uint32_t period_us) noexcept
    : timed_(timed), table_(table), period_us_(period_us) {
  size_ = static_cast<std::uint32_t>(std::ceil(timed.duration_s * 1e6 / period_us)) + 1;
  end_ = stretch_end(timed_.path, 0);
  span_ = PathSpan(timed_.path, begin_, end_, 0);
}

bool Sampler::next(SetPoint& out) noexcept {
  if (index_ == size_) {
    return false;
  }
  out.t_us = index_ * period_us_;
  ++index_;
  const double t_s = 1e-6 * out.t_us;
  advance(front_, t_s);
  advance(back_, t_s - timed_.window_s);
  const TimeNode& node = timed_.nodes[front_.node];
  if (node.rests) {
    rest(node.point, out);
  } else {
    const double window_s = std::max(timed_.window_s, 1e-9);
    move((front_.integral_mm_s - back_.integral_mm_s) / window_s,
         (front_.s_mm - back_.s_mm) / window_s, out);
  }
  const TimeNode& limited = timed_.nodes[node.last_limited];
  out.limited_by = node.last_limited >= back_.node ? limited.limited_by : LimitKind::kNone;
  return true;
}

void Sampler::advance(Cursor& cursor, double t_s) const noexcept {
  const auto& nodes = timed_.nodes;
  while (cursor.node + 1 < nodes.size() && nodes[cursor.node + 1].t_s <= t_s) {
    ++cursor.node;
  }
  if (t_s <= 0.0) {
    return;  // Before its beginning the path stands at s = 0.
  }
  const TimeNode& a = nodes[cursor.node];
  const double dt = t_s - a.t_s;
  double acceleration = 0.0;
  if (cursor.node + 1 < nodes.size() && !a.rests) {
    const TimeNode& b = nodes[cursor.node + 1];
    acceleration = b.t_s > a.t_s ? (b.v_mm_s - a.v_mm_s) / (b.t_s - a.t_s) : 0.0;
  }
  cursor.s_mm = a.s_mm + dt * (a.v_mm_s + 0.5 * dt * acceleration);
  cursor.integral_mm_s =
      a.integral_mm_s + dt * (a.s_mm + dt * (a.v_mm_s / 2.0 + dt * acceleration / 6.0));
}

/// Moves `span_` forward to where `s_mm` lies, within the stretch that the front has reached.
void Sampler::find_span(double s_mm) noexcept {
  const torch::PathView path = timed_.path;
  const std::size_t front_point = timed_.nodes[front_.node].point;
  while (front_point >= end_ && end_ + 1 < path.size()) {
    begin_ = end_;
    end_ = stretch_end(path, begin_);
    point_ = begin_;
    span_ = PathSpan(path, begin_, end_, point_);
  }
  while (point_ + 1 < end_ && span_.s_at(1.0) <= s_mm) {
    ++point_;
    span_ = PathSpan(path, begin_, end_, point_);
  }
}

void Sampler::move(double s_mm, double speed_mm_s, SetPoint& out) noexcept {
  const double s_path_mm = s_mm + timed_.path[0].s_mm;
  find_span(s_path_mm);
  out.pose = span_.pose_at(span_.parameter_at(s_path_mm));
  out.s_mm = s_path_mm;
  out.speed_mm_s = speed_mm_s;
  set_process(timed_.path[point_], out);
}

void Sampler::rest(std::size_t point, SetPoint& out) const noexcept {
  out.pose = timed_.path[point].pose;
  out.s_mm = timed_.path[point].s_mm;
  out.speed_mm_s = 0.0;
  set_process(timed_.path[point], out);
}

void Sampler::set_process(const torch::PathPoint& point, SetPoint& out) const noexcept {
  const WeldSchedule schedule = point.arc ? table_.at(point.schedule) : WeldSchedule{0.0, 0.0};
  out.wire_feed_m_min = schedule.wire_feed_m_min;
  out.voltage_v = schedule.voltage_v;
  out.segment = point.segment;
  out.arc = point.arc;
  out.gas = point.gas;
  out.wire = point.wire;
  out.pass = point.pass;
  out.schedule = point.schedule;
  out.confidence = point.confidence;
}

bool sample_all(Sampler& sampler, Buffer<SetPoint>& out) noexcept {
  SetPoint point;
  while (sampler.next(point)) {
    if (!out.append(point)) {
      return false;
    }
  }
  return true;
}

}  // namespace dseam::trajectory
