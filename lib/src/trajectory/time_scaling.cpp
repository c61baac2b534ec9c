// SPDX-License-Identifier: Apache-2.0
// The nodes of the time law. time_limits.cpp finds what speed, acceleration and jerk each cell may
// have, time_scaling_speed.cpp the speed that it gets.
#include "dseam/trajectory/time_scaling.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/trajectory/path_spline.hpp"
#include "stretch.hpp"

namespace dseam::trajectory {
namespace {

constexpr int kSamplesPerCell = 4;        // The rates' maxima are looked for at five places.
constexpr double kSampleMargin = 1.001;   // For what lies between them.
constexpr double kMaxDurationS = 4294.0;  // 2^32 microseconds.

PathRates largest_rates(const PathSpan& span, double u0, double u1) noexcept {
  PathRates most;
  for (int k = 0; k <= kSamplesPerCell; ++k) {
    const PathRates r = span.rates_at(u0 + (u1 - u0) * k / kSamplesPerCell);
    most.tangent = std::max(most.tangent, r.tangent);
    most.curvature = std::max(most.curvature, r.curvature);
    most.third = std::max(most.third, r.third);
    most.turn = std::max(most.turn, r.turn);
    most.turn_rate = std::max(most.turn_rate, r.turn_rate);
  }
  // A turn between two samples exceeds both by no more than its own rate allows.
  const double half_gap_mm = 0.5 * (span.s_at(u1) - span.s_at(u0)) / kSamplesPerCell;
  most.turn += half_gap_mm * most.turn_rate;
  // The tangent's length does so only to second order.
  most.tangent += 0.5 * half_gap_mm * half_gap_mm *
                  (most.third + most.curvature * most.curvature / most.tangent);
  return {most.tangent * kSampleMargin, most.curvature * kSampleMargin, most.third * kSampleMargin,
          most.turn * kSampleMargin, most.turn_rate * kSampleMargin};
}

bool is_finite(const torch::PathPoint& p) noexcept {
  return p.pose.p_base.allFinite() && p.pose.q_base_torch.coeffs().allFinite() &&
         std::isfinite(p.s_mm) && std::isfinite(p.speed_mm_s) && std::isfinite(p.dwell_s);
}

bool is_sane(const torch::PathPoint& p) noexcept {
  return is_finite(p) && p.speed_mm_s > 0.0 && p.dwell_s >= 0.0 &&
         std::abs(p.pose.q_base_torch.norm() - 1.0) < 1e-6;
}

}  // namespace

bool is_valid(const Limits& limits) noexcept {
  const double all[] = {limits.speed_mm_s, limits.acceleration_mm_s2, limits.jerk_mm_s3,
                        limits.angular_speed_rad_s, limits.angular_acceleration_rad_s2};
  return std::all_of(std::begin(all), std::end(all),
                     [](double v) { return std::isfinite(v) && v > 0.0; });
}

Result<TimeScaling> TimeScaling::make(const Limits& limits, std::size_t max_points,
                                      Arena& arena) noexcept {
  if (!is_valid(limits)) {
    return Errc::kInvalidArgument;
  }
  const auto nodes = arena.take<TimeNode>(nodes_for(max_points));
  const auto cells = arena.take<Cell>(nodes_for(max_points));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return TimeScaling(limits, nodes, cells);
}

TimedPathView TimeScaling::timed_path() const noexcept {
  return {path_, nodes_.first(num_nodes_), window_s_, duration_s_};
}

TimeScaling::Report TimeScaling::run(torch::PathView path) noexcept {
  Report report;
  num_nodes_ = 0;
  duration_s_ = 0.0;
  path_ = {};
  report.state = check(path);
  if (report.state != State::kTimed) {
    return report;
  }
  bool fits = cut_path(path);
  choose_acceleration();
  fits = fits && append_rest(0, 0.0, path[0].dwell_s);
  for (std::size_t begin = 0, cell = 0; fits && begin + 1 < path.size();) {
    const std::size_t end = stretch_end(path, begin);
    std::size_t end_cell = cell;
    while (end_cell < num_cells_ && cells_[end_cell].point < end) {
      ++end_cell;
    }
    if (end_cell > cell) {
      fits = append_stretch(cells_.subspan(cell, end_cell - cell), path[begin].s_mm - path[0].s_mm,
                            report);
      ++report.stops;
    }
    fits = fits && append_rest(end, path[end].s_mm - path[0].s_mm, path[end].dwell_s);
    begin = end;
    cell = end_cell;
  }
  const double length_mm = path.back().s_mm - path.front().s_mm;
  fits = fits && append_node({duration_s_, length_mm, 0.0, 0.0,
                              static_cast<std::uint32_t>(path.size() - 1), LimitKind::kNone, true});
  if (!fits || !(duration_s_ < kMaxDurationS)) {
    num_nodes_ = 0;
    report.state = State::kTooLong;
    return report;
  }
  path_ = path;
  report.duration_s = duration_s_;
  report.length_mm = length_mm;
  return report;
}

TimeScaling::State TimeScaling::check(torch::PathView path) const noexcept {
  if (path.size() < 2) {
    return State::kTooFewPoints;
  }
  bool rests = path[0].dwell_s > 0.0;
  if (!is_sane(path[0])) {
    return State::kBadPoint;
  }
  for (std::size_t i = 1; i < path.size(); ++i) {
    const torch::PathPoint& a = path[i - 1];
    const torch::PathPoint& b = path[i];
    if (!is_sane(b) || b.s_mm < a.s_mm) {
      return State::kBadPoint;
    }
    rests = rests || b.dwell_s > 0.0;
    if (b.s_mm - a.s_mm > kSamePlaceMm) {
      continue;
    }
    if ((b.pose.p_base - a.pose.p_base).norm() > kSamePlaceMm) {
      return State::kBadPoint;
    }
    if (std::abs(a.pose.q_base_torch.dot(b.pose.q_base_torch)) < 1.0 - 1e-12) {
      return State::kTurnsOnTheSpot;
    }
  }
  const bool moves = path.back().s_mm - path.front().s_mm > kSamePlaceMm;
  return moves || rests ? State::kTimed : State::kNoLength;
}

bool TimeScaling::cut_path(torch::PathView path) noexcept {
  bool fits = true;
  num_cells_ = 0;
  for (std::size_t begin = 0; fits && begin + 1 < path.size();) {
    const std::size_t end = stretch_end(path, begin);
    fits = path[end].s_mm - path[begin].s_mm <= kSamePlaceMm || cut_stretch(path, begin, end);
    begin = end;
  }
  return fits;
}

bool TimeScaling::cut_stretch(torch::PathView path, std::size_t begin, std::size_t end) noexcept {
  const std::size_t intervals = end - begin;
  const std::size_t pieces = (kMinCells + intervals - 1) / intervals;
  if (intervals * pieces > cells_.size() - num_cells_) {
    return false;
  }
  for (std::size_t i = begin; i < end; ++i) {
    const PathSpan span(path, begin, end, i);
    for (std::size_t k = 0; k < pieces; ++k) {
      Cell& cell = cells_[num_cells_++];
      const auto u = [&](std::size_t n) {
        return static_cast<double>(n) / static_cast<double>(pieces);
      };
      cell.point = static_cast<std::uint32_t>(i);
      cell.length_mm = span.s_at(u(k + 1)) - span.s_at(u(k));
      cell.rates = largest_rates(span, u(k), u(k + 1));
      bound_speed(path[i].speed_mm_s, cell);
    }
  }
  return true;
}

bool TimeScaling::append_stretch(std::span<Cell> cells, double s_mm, Report& report) noexcept {
  const double acceleration_mm_s2 = acceleration_on(cells);
  erode(cells, acceleration_mm_s2);
  ramp(cells, acceleration_mm_s2);
  hold_peaks(cells);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    Cell& cell = cells[k];
    const double next_v = k + 1 < cells.size() ? cells[k + 1].v_mm_s : 0.0;
    const bool held_back = std::min(cell.v_mm_s, next_v) < cell.max_v_mm_s * (1.0 - 1e-9);
    if (held_back && cell.limited_by == LimitKind::kNone) {
      cell.limited_by = LimitKind::kRamp;
    }
    if (!append_node({duration_s_, s_mm, cell.v_mm_s, 0.0, cell.point, cell.limited_by, false})) {
      return false;
    }
    report.slowed_mm[static_cast<std::size_t>(cell.limited_by)] += cell.length_mm;
    duration_s_ += 2.0 * cell.length_mm / (cell.v_mm_s + next_v);
    s_mm += cell.length_mm;
  }
  // The smoothed torch comes to rest a window later.
  const bool fits =
      append_node({duration_s_, s_mm, 0.0, 0.0, cells.back().point, LimitKind::kRamp, false});
  duration_s_ += window_s_;
  return fits;
}

bool TimeScaling::append_rest(std::size_t point, double s_mm, double rest_s) noexcept {
  if (!(rest_s > 0.0)) {
    return true;
  }
  const bool fits = append_node(
      {duration_s_, s_mm, 0.0, 0.0, static_cast<std::uint32_t>(point), LimitKind::kRamp, true});
  duration_s_ += rest_s;
  return fits;
}

/// Appends a node and carries the integral of s on from the node before it.
bool TimeScaling::append_node(TimeNode node) noexcept {
  if (num_nodes_ == nodes_.size()) {
    return false;
  }
  if (num_nodes_ > 0) {
    const TimeNode& a = nodes_[num_nodes_ - 1];
    const double dt = node.t_s - a.t_s;
    node.integral_mm_s =
        a.integral_mm_s + dt * (a.s_mm + dt * (a.v_mm_s / 3.0 + node.v_mm_s / 6.0));
  }
  const bool limited = node.limited_by != LimitKind::kNone;
  node.last_limited = limited ? static_cast<std::uint32_t>(num_nodes_)
                              : (num_nodes_ > 0 ? nodes_[num_nodes_ - 1].last_limited : 0);
  nodes_[num_nodes_++] = node;
  return true;
}

}  // namespace dseam::trajectory
