// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/torch_planner.hpp"

#include <algorithm>
#include <cmath>

#include "local_quadratic.hpp"

namespace dseam::torch {
namespace {

using Eigen::Vector3d;

constexpr double kMinChordMm = 1e-6;
constexpr double kMinNormal = 0.1;  // A smoothed normal shorter than this points nowhere.
constexpr double kMinOpening =
    0.05;  // rad; flatter or sharper joints have no bisector to speak of.
constexpr double kFewestInWindow = 2.6;  // Half width of the window in point distances, at least.

/// Cubic Hermite segment of unit parameter: position and derivative.
struct Hermite {
  Vector3d p0, d0, p1, d1;

  Vector3d at(double u) const noexcept {
    const double v = 1.0 - u;
    return v * v * (1.0 + 2.0 * u) * p0 + u * v * v * d0 + u * u * (1.0 + 2.0 * v) * p1 -
           u * u * v * d1;
  }
  Vector3d slope(double u) const noexcept {
    const double v = 1.0 - u;
    return 6.0 * u * v * (p1 - p0) + v * (1.0 - 3.0 * u) * d0 + u * (3.0 * u - 2.0) * d1;
  }
  /// Arc length of [0, u] by four-point Gauss-Legendre quadrature.
  double length(double u) const noexcept {
    constexpr double kNode[] = {0.3399810435848563, 0.8611363115940526};
    constexpr double kWeight[] = {0.6521451548625461, 0.3478548451374538};
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
      sum += kWeight[i] *
             (slope(0.5 * u * (1.0 - kNode[i])).norm() + slope(0.5 * u * (1.0 + kNode[i])).norm());
    }
    return 0.5 * u * sum;
  }
  /// The parameter at which the length is `target_mm`.
  double parameter_at(double target_mm, double total_mm) const noexcept {
    double u = std::clamp(target_mm / total_mm, 0.0, 1.0);
    for (int i = 0; i < 4; ++i) {
      u = std::clamp(u - (length(u) - target_mm) / slope(u).norm(), 0.0, 1.0);
    }
    return u;
  }
};

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

/// `v` turned towards `to` until it is within `limit_rad` of it.
Vector3d within(const Vector3d& v, const Vector3d& to, double limit_rad) noexcept {
  const Vector3d side = v - to * to.dot(v);
  const double sine = side.norm();
  if (std::atan2(sine, to.dot(v)) <= limit_rad || sine < 1e-9) {
    return v;
  }
  return std::cos(limit_rad) * to + std::sin(limit_rad) / sine * side;
}

double angle_between(const Vector3d& a, const Vector3d& b) noexcept {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Height of the contact tip's rim over a plane through the root.
double clearance_over(const Vector3d& normal, const Vector3d& body, double stick_out_mm,
                      double tip_radius_mm) noexcept {
  const double sine = body.dot(normal);
  return stick_out_mm * sine - tip_radius_mm * std::sqrt(std::max(0.0, 1.0 - sine * sine));
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
  const double width_mm = std::max(config_.smoothing_mm, kFewestInWindow * spacing_mm);
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
    point.weldable = judge(seam.points[(u < 0.5 ? a : b).source], point, work_error_rad);
  }
  return point;
}

/// Sets the orientation from the joint; false, and kDegenerate, where it does not span one.
bool TorchPlanner::orient(Joint joint, TorchPoint& point, double& work_error_rad) const noexcept {
  const double speed = joint.tangent.norm();
  const Vector3d t = joint.tangent / speed;
  Vector3d n1 = joint.n_shell - t * t.dot(joint.n_shell);
  Vector3d n2 = joint.n_nozzle - t * t.dot(joint.n_nozzle);
  if (!(speed > 0.0) || !(n1.norm() > kMinNormal) || !(n2.norm() > kMinNormal)) {
    return false;
  }
  n1.normalize();
  n2.normalize();
  const double between = angle_between(n1, n2);
  if (!in(between, kMinOpening, std::numbers::pi - kMinOpening)) {
    return false;
  }
  const Vector3d along_shell = (n2 - n1 * n1.dot(n2)).normalized();  // Away from the root.
  point.tangent = t;
  point.dihedral_rad = std::numbers::pi - between;
  point.out = (n1 + n2).normalized();
  point.across = (n1 - n2).normalized();
  const double work = config_.work_fraction * point.dihedral_rad + config_.work_offset_rad;
  const Vector3d upright = std::cos(work) * along_shell + std::sin(work) * n1;
  const Vector3d asked =
      std::cos(config_.travel_angle_rad) * upright - std::sin(config_.travel_angle_rad) * t;
  const Vector3d body = within(asked, config_.up_base, config_.max_tilt_rad);
  work_error_rad = angle_between(asked, body);
  const Vector3d ahead = t - body * body.dot(t);
  if (!(ahead.norm() > kMinNormal)) {
    return false;
  }
  Eigen::Matrix3d R_base_torch;
  R_base_torch.col(0) = ahead.normalized();
  R_base_torch.col(2) = -body;
  R_base_torch.col(1) = R_base_torch.col(2).cross(R_base_torch.col(0));
  point.pose.q_base_torch = Eigen::Quaterniond(R_base_torch).normalized();
  point.clearance_mm =
      std::min(clearance_over(n1, body, config_.stick_out_mm, config_.tip_radius_mm),
               clearance_over(n2, body, config_.stick_out_mm, config_.tip_radius_mm));
  return true;
}

Weldable TorchPlanner::judge(const seam::SeamPoint& nearest, const TorchPoint& point,
                             double work_error_rad) const noexcept {
  if (!in(point.dihedral_rad, config_.min_dihedral_rad, config_.max_dihedral_rad)) {
    return Weldable::kDihedral;
  }
  if (nearest.source == seam::Source::kInterpolated && !config_.weld_interpolated) {
    return Weldable::kInterpolated;
  }
  if (nearest.source == seam::Source::kMeasured && nearest.confidence < config_.min_confidence) {
    return Weldable::kLowConfidence;
  }
  if (!(nearest.gap_mm <= config_.max_gap_mm)) {
    return Weldable::kGap;
  }
  if (!(point.clearance_mm >= config_.min_clearance_mm)) {
    return Weldable::kNoClearance;
  }
  return work_error_rad <= config_.max_work_error_rad ? Weldable::kYes : Weldable::kTilt;
}

/// Gives degenerate points the orientation before them, signs every quaternion like its
/// predecessor, and marks where the torch would have to turn too fast.
void TorchPlanner::limit_turns(std::span<TorchPoint> points, Report& report) const noexcept {
  const auto usable = [](const TorchPoint& p) { return p.weldable != Weldable::kDegenerate; };
  const auto first = std::find_if(points.begin(), points.end(), usable);
  Eigen::Quaterniond before =
      first == points.end() ? Eigen::Quaterniond::Identity() : first->pose.q_base_torch;
  for (std::size_t i = 0; i < points.size(); ++i) {
    TorchPoint& point = points[i];
    Eigen::Quaterniond& q = point.pose.q_base_torch;
    if (!usable(point)) {
      q = before;
    }
    if (q.dot(before) < 0.0) {
      q.coeffs() = -q.coeffs();
    }
    const double step_mm = i == 0 ? report.length_mm : point.s_mm - points[i - 1].s_mm;
    const double rate = before.angularDistance(q) / step_mm;
    report.max_turn_rad_per_mm = std::max(report.max_turn_rad_per_mm, rate);
    if (rate > config_.max_turn_rad_per_mm && point.weldable == Weldable::kYes) {
      point.weldable = Weldable::kTurnsTooFast;
    }
    before = q;
  }
}

}  // namespace dseam::torch
