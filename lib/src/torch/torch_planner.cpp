// SPDX-License-Identifier: Apache-2.0
// The curve: arc length, stations, smoothing. torch_planner_pose.cpp puts the torch over it.
#include "dseam/torch/torch_planner.hpp"

#include <algorithm>
#include <cmath>

#include "hermite.hpp"
#include "local_quadratic.hpp"

namespace dseam::torch {
namespace {

using Eigen::Vector3d;

constexpr double kMinChordMm = 1e-6;
constexpr double kFewestInWindow = 2.6;  // Half width of the window in point distances, at least.
constexpr double kWidestShare = 0.05;    // And of the seam's length, at most: it bends with that.

bool in(double v, double low, double high) noexcept { return v >= low && v <= high; }

bool is_valid(const TorchPlanner::Config& c) noexcept {
  constexpr double kPi = std::numbers::pi;
  return in(c.step_mm, 0.01, 10.0) && in(c.smoothing_mm, 0.01, 50.0) &&
         in(c.work_fraction, 0.0, 1.0) && in(c.work_offset_rad, -kPi, kPi) &&
         in(c.travel_angle_rad, -1.2, 1.2) && in(c.stick_out_mm, 0.0, 200.0) &&
         in(c.tip_radius_mm, 0.0, 100.0) && in(c.min_clearance_mm, -100.0, 100.0) &&
         in(c.min_dihedral_rad, 0.0, kPi) && in(c.max_dihedral_rad, c.min_dihedral_rad, kPi) &&
         in(c.max_gap_mm, 0.0, 1e3) && in(c.max_tilt_rad, 0.0, kPi) &&
         in(c.max_work_error_rad, 0.0, kPi) && in(c.max_turn_rad_per_mm, 1e-6, 1e3) &&
         in(c.up_base.norm(), 0.999, 1.001);
}

}  // namespace

Result<TorchPlanner> TorchPlanner::make(const Config& config, std::size_t max_seam_points,
                                        Arena& arena) noexcept {
  if (!is_valid(config)) {
    return Errc::kInvalidArgument;
  }
  const auto stations = arena.take<Station>(max_seam_points + 1);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return TorchPlanner(config, stations);
}

TorchPlanner::Report TorchPlanner::run(const seam::SeamView& seam,
                                       Buffer<TorchPoint>& out) noexcept {
  Report report;
  out.clear();
  report.state = lay_stations(seam);
  if (report.state != State::kPlanned) {
    return report;
  }
  set_slopes();
  measure();
  report.length_mm = stations_[num_segments()].s_mm;
  const double steps = std::ceil(report.length_mm / config_.step_mm);
  if (!(steps + 1.0 <= static_cast<double>(out.capacity()))) {
    report.state = State::kFull;
    return report;
  }
  const auto count = static_cast<std::size_t>(steps) + (closed_ ? 0 : 1);
  std::size_t segment = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double s_mm = report.length_mm * static_cast<double>(k) / steps;
    while (segment + 1 < num_segments() && stations_[segment + 1].s_mm <= s_mm) {
      ++segment;
    }
    (void)out.append(point_at(seam, segment, s_mm));
  }
  limit_turns(out.items(), report);
  for (const TorchPoint& point : out.view()) {
    ++report.by_weldable[static_cast<std::size_t>(point.weldable)];
  }
  report.points = static_cast<std::uint32_t>(out.size());
  return report;
}

TorchPlanner::State TorchPlanner::lay_stations(const seam::SeamView& seam) noexcept {
  const std::size_t n = seam.points.size();
  if (n < 4) {
    return State::kNoSeam;
  }
  if (n + 1 > stations_.size()) {
    return State::kTooLong;
  }
  size_ = n;
  closed_ = seam.closed;
  for (std::size_t i = 0; i < n + (closed_ ? 1 : 0); ++i) {
    const std::size_t k = i % n;
    Station& station = stations_[i];
    // Reversed, a closed curve still begins at its first point.
    const std::size_t back = closed_ ? (n - k) % n : n - 1 - k;
    station.source = static_cast<std::uint32_t>(config_.reversed ? back : k);
    station.p = seam.points[station.source].p_base;
    if (!station.p.allFinite()) {
      return State::kBadPoint;
    }
    const double chord_mm = i == 0 ? 0.0 : (station.p - stations_[i - 1].p).norm();
    if (i > 0 && !(chord_mm > kMinChordMm)) {
      return State::kBadPoint;
    }
    station.chord_mm = i == 0 ? 0.0 : stations_[i - 1].chord_mm + chord_mm;
  }
  return State::kPlanned;
}

/// Slopes of the parabola through each point and its two neighbours.
void TorchPlanner::set_slopes() noexcept {
  const auto slope_at = [&](std::size_t i0, std::size_t i1, std::size_t i2, double shift_mm,
                            std::size_t where) {
    const Station& a = stations_[i0];
    const Station& b = stations_[i1];
    const Station& c = stations_[i2];
    const double h0 = b.chord_mm - a.chord_mm + shift_mm;
    const double h1 = c.chord_mm - b.chord_mm;
    const Vector3d d0 = (b.p - a.p) / h0;
    const Vector3d d1 = (c.p - b.p) / h1;
    const Vector3d bend = (d1 - d0) / (h0 + h1);
    if (where == i0) {
      return Vector3d(d0 - h0 * bend);
    }
    return where == i1 ? Vector3d(d0 + h0 * bend) : Vector3d(d1 + h1 * bend);
  };
  for (std::size_t i = 1; i + 1 < size_ + (closed_ ? 1 : 0); ++i) {
    stations_[i].dp = slope_at(i - 1, i, i + 1, 0.0, i);
  }
  if (closed_) {
    stations_[0].dp = slope_at(size_ - 1, 0, 1, stations_[size_].chord_mm, 0);
    stations_[size_].dp = stations_[0].dp;
  } else {
    stations_[0].dp = slope_at(0, 1, 2, 0.0, 0);
    stations_[size_ - 1].dp = slope_at(size_ - 3, size_ - 2, size_ - 1, 0.0, size_ - 1);
  }
}

namespace {

template <typename Station>
Hermite segment_between(const Station& a, const Station& b) noexcept {
  const double h = b.chord_mm - a.chord_mm;
  return {a.p, h * a.dp, b.p, h * b.dp};
}

}  // namespace

void TorchPlanner::measure() noexcept {
  for (std::size_t i = 0; i < num_segments(); ++i) {
    stations_[i + 1].s_mm =
        stations_[i].s_mm + segment_between(stations_[i], stations_[i + 1]).length(1.0);
  }
}

TorchPlanner::Joint TorchPlanner::smoothed_joint(const seam::SeamView& seam, std::size_t near,
                                                 double chord_mm) const noexcept {
  const double total_mm = stations_[num_segments()].chord_mm;
  const double spacing_mm = total_mm / static_cast<double>(num_segments());
  const double smoothing_mm = std::min(config_.smoothing_mm, kWidestShare * total_mm);
  const double width_mm = std::max(smoothing_mm, kFewestInWindow * spacing_mm);
  LocalQuadratic place;
  LocalQuadratic shell;
  LocalQuadratic nozzle;
  const auto add = [&](std::size_t i, double shift_mm) {
    const Station& station = stations_[i];
    const double x = (station.chord_mm + shift_mm - chord_mm) / width_mm;
    if (std::abs(x) >= 1.0) {
      return false;
    }
    const seam::SeamPoint& point = seam.points[station.source];
    place.add(x, station.p - stations_[near].p);
    if (point.n_shell.allFinite() && point.n_nozzle.allFinite()) {
      shell.add(x, point.n_shell);
      nozzle.add(x, point.n_nozzle);
    }
    return true;
  };
  for (std::size_t k = 0; k < size_; ++k) {  // Backward from here, round the end if closed.
    const bool wraps = k > near;
    if ((wraps && !closed_) || !add(wraps ? near + size_ - k : near - k, wraps ? -total_mm : 0.0)) {
      break;
    }
  }
  for (std::size_t k = near + 1; k < near + size_; ++k) {
    const bool wraps = k >= size_;
    if ((wraps && !closed_) || !add(wraps ? k - size_ : k, wraps ? total_mm : 0.0)) {
      break;
    }
  }
  return {place.slope(), shell.value(), nozzle.value()};
}

TorchPoint TorchPlanner::point_at(const seam::SeamView& seam, std::size_t segment,
                                  double s_mm) const noexcept {
  const Station& a = stations_[segment];
  const Station& b = stations_[segment + 1];
  const Hermite curve = segment_between(a, b);
  const double u = curve.parameter_at(s_mm - a.s_mm, b.s_mm - a.s_mm);
  TorchPoint point;
  point.s_mm = s_mm;
  point.pose.p_base = curve.at(u);
  const double chord_mm = a.chord_mm + u * (b.chord_mm - a.chord_mm);
  double work_error_rad = 0.0;
  if (orient(smoothed_joint(seam, segment, chord_mm), point, work_error_rad)) {
    const seam::SeamPoint& nearest = seam.points[(u < 0.5 ? a : b).source];
    point.confidence = nearest.confidence;
    point.weldable = judge(nearest, point, work_error_rad);
  }
  return point;
}

}  // namespace dseam::torch
