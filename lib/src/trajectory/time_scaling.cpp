// SPDX-License-Identifier: Apache-2.0
// The nodes of the time law. time_scaling_speed.cpp finds the speed of each cell.
#include "dseam/trajectory/time_scaling.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/trajectory/path_spline.hpp"
#include "stretch.hpp"
#include "time_shares.hpp"

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
  choose_window(path);
  bool fits = append_rest(0, 0.0, path[0].dwell_s);
  for (std::size_t begin = 0; fits && begin + 1 < path.size();) {
    const std::size_t end = stretch_end(path, begin);
    const double s_end = path[end].s_mm - path[0].s_mm;
    if (path[end].s_mm - path[begin].s_mm > kSamePlaceMm) {
      fits = cut_cells(path, begin, end) && append_stretch(path, begin, report);
      ++report.stops;
    }
    fits = fits && append_rest(end, s_end, path[end].dwell_s);
    begin = end;
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

/// One window for the whole path: wide enough for the jerk wherever the path bends most, and no
/// wider than reaching the highest speed needs.
void TimeScaling::choose_window(torch::PathView path) noexcept {
  double tangent = 1.0;
  double speed = 0.0;
  for (std::size_t begin = 0; begin + 1 < path.size();) {
    const std::size_t end = stretch_end(path, begin);
    for (std::size_t i = begin; i < end && path[i + 1].s_mm - path[i].s_mm > kSamePlaceMm; ++i) {
      const PathSpan span(path, begin, end, i);
      tangent = std::max(tangent, largest_rates(span, 0.0, 1.0).tangent);
      speed = std::max(speed, std::min(path[i].speed_mm_s, limits_.speed_mm_s));
    }
    begin = end;
  }
  const double jerk = kJerkAlong * limits_.jerk_mm_s3 / tangent;
  max_acceleration_mm_s2_ =
      std::min(kAlongShare * limits_.acceleration_mm_s2 / tangent, std::sqrt(0.5 * speed * jerk));
  window_s_ = 2.0 * max_acceleration_mm_s2_ / jerk;
}

bool TimeScaling::cut_cells(torch::PathView path, std::size_t begin, std::size_t end) noexcept {
  const std::size_t intervals = end - begin;
  const std::size_t pieces = (kMinCells + intervals - 1) / intervals;
  double most_turn = 0.0;
  num_cells_ = 0;
  if (intervals * pieces > cells_.size()) {
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
      most_turn = std::max(most_turn, cell.rates.turn);
    }
  }
  stretch_acceleration_mm_s2_ = max_acceleration_mm_s2_;
  if (most_turn > 0.0) {
    stretch_acceleration_mm_s2_ = std::min(
        stretch_acceleration_mm_s2_, kAlongShare * limits_.angular_acceleration_rad_s2 / most_turn);
  }
  for (std::size_t k = 0; k < num_cells_; ++k) {
    bound_cell(path[cells_[k].point].speed_mm_s, cells_[k]);
  }
  erode();
  ramp();
  return true;
}

bool TimeScaling::append_stretch(torch::PathView path, std::size_t begin, Report& report) noexcept {
  double s = path[begin].s_mm - path[0].s_mm;
  for (std::size_t k = 0; k < num_cells_; ++k) {
    const Cell& cell = cells_[k];
    const double next_v = k + 1 < num_cells_ ? cells_[k + 1].v_mm_s : 0.0;
    if (!append_node({duration_s_, s, cell.v_mm_s, 0.0, cell.point, cell.limited_by, false})) {
      return false;
    }
    report.slowed_mm[static_cast<std::size_t>(cell.limited_by)] += cell.length_mm;
    duration_s_ += 2.0 * cell.length_mm / (cell.v_mm_s + next_v);
    s += cell.length_mm;
  }
  // The smoothed torch comes to rest a window later.
  const bool fits = append_node(
      {duration_s_, s, 0.0, 0.0, cells_[num_cells_ - 1].point, LimitKind::kRamp, false});
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
