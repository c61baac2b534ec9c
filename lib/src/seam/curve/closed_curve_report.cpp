// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/curve/closed_curve_fit.hpp"
#include "dseam/seam/curve/quality.hpp"
#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/surface/surface_fit.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kSpacingsPerBin = 2.5;  // A stretch this long without a point is a hole.
constexpr int kSurfaceSteps = 40;

}  // namespace

// Angles about the nozzle; the width in mm is along its surface, without the climb.
void ClosedCurveFit::find_hole(Report& report) noexcept {
  const NozzleFrame frame = frame_of(report.nozzle);
  std::size_t n = 0;
  for (const Station& s : stations_.first(count_)) {
    if (s.used) {
      sorted_[n++] = angle_about(report.nozzle, frame, s.p);
    }
  }
  std::sort(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const double next = i + 1 < n ? sorted_[i + 1] : sorted_[0] + kTurnRad;
    report.largest_hole_rad = std::max(report.largest_hole_rad, next - sorted_[i]);
  }
  report.largest_hole_mm = report.largest_hole_rad * report.nozzle.radius_mm;
}

// Root mean square distance after the fit; huge when it does not converge.
double ClosedCurveFit::fit_surface(Surface& surface) const noexcept {
  double rms = 1e300;
  for (int step = 0; step < kSurfaceSteps; ++step) {
    SurfaceEquations equations(surface);
    for (const Station& s : stations_.first(count_)) {
      if (s.used) {
        equations.add(s.p);
      }
    }
    const double now = std::sqrt(equations.weighted_squares() / std::max(1.0, equations.weight()));
    const std::optional<Surface> next = equations.solve();
    if (!next) {
      return 1e300;
    }
    if (std::abs(now - rms) < 1e-9) {
      return now;
    }
    rms = now;
    surface = *next;
  }
  return rms;
}

bool ClosedCurveFit::fit_surfaces(Report& report) noexcept {
  double radius = 0.0;
  for (const Station& s : stations_.first(count_)) {
    const Eigen::Vector3d q = s.p - centre_;
    radius += (q - q.dot(up_) * up_).norm() / static_cast<double>(count_);
  }
  report.nozzle = {SurfaceKind::kCylinder, centre_, up_, radius, 0.0};
  report.nozzle_rms_mm = fit_surface(report.nozzle);
  fit_shell(report);
  if (!(report.nozzle_rms_mm < 0.2 * radius && report.shell_rms_mm < 0.2 * radius)) {
    return false;
  }
  // Out of the shell: away from its axis or centre, up from a plane.
  const bool plane = report.shell.kind == SurfaceKind::kPlane;
  const Eigen::Vector3d outward = outward_normal(report.shell, centre_);
  if (report.nozzle.axis.dot(outward) < 0.0) {
    report.nozzle.axis = -report.nozzle.axis;
  }
  const double cosine = std::abs(report.nozzle.axis.dot(report.shell.axis));
  const Eigen::Vector3d common = report.nozzle.axis.cross(report.shell.axis);
  report.axes_angle_rad = std::acos(std::min(1.0, cosine));
  report.axes_offset_mm =
      plane || common.norm() < 1e-6
          ? 0.0
          : std::abs((report.shell.point - report.nozzle.point).dot(common.normalized()));
  return true;
}

// The nozzle itself also goes through every point; the shell is what does so across it.
void ClosedCurveFit::fit_shell(Report& report) const noexcept {
  constexpr int kDirections = 6;
  report.shell = {SurfaceKind::kPlane, centre_, up_, 0.0, 0.0};
  report.shell_rms_mm = fit_surface(report.shell);
  const AcrossAxis frame = across(up_);
  for (int i = 0; i < 4 * kDirections; ++i) {
    const double angle = std::numbers::pi * (i % kDirections) / kDirections;
    const Eigen::Vector3d axis = std::cos(angle) * frame.u + std::sin(angle) * frame.v;
    const double radius = report.nozzle.radius_mm * (i / (2 * kDirections) == 0 ? 1.5 : 4.0);
    const Eigen::Vector3d below = (i / kDirections % 2 == 0 ? radius : -radius) * up_;
    Surface trial{SurfaceKind::kCylinder, centre_ + below, axis, radius, 0.0};
    const double rms = fit_surface(trial);
    const bool across_nozzle = std::abs(trial.axis.dot(report.nozzle.axis)) < 0.8;
    if (across_nozzle && rms < 0.7 * report.shell_rms_mm) {
      report.shell = trial;
      report.shell_rms_mm = rms;
    }
  }
}

ResidualStats ClosedCurveFit::stats_of(std::size_t count) noexcept {
  ResidualStats stats;
  stats.count = static_cast<std::uint32_t>(count);
  const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(count);
  for (auto it = sorted_.begin(); it != end; ++it) {
    stats.rms_mm += *it * *it / static_cast<double>(count);
    stats.max_mm = std::max(stats.max_mm, std::abs(*it));
    *it = std::abs(*it);
  }
  stats.rms_mm = std::sqrt(stats.rms_mm);
  const auto place = sorted_.begin() + static_cast<std::ptrdiff_t>(count * 95 / 100);
  std::nth_element(sorted_.begin(), place, end);
  stats.p95_mm = *place;
  return stats;
}

// All points count here, outliers too.
void ClosedCurveFit::describe(Report& report) noexcept {
  const double n = static_cast<double>(count_);
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();
  const auto fill = [&](auto&& value) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Jet jet = at(stations_[i].t_rad);
      sorted_[i] = value(stations_[i], jet);
    }
    return stats_of(count_);
  };
  report.orthogonal = fill([](const Station& s, const Jet& jet) { return (jet.p - s.p).norm(); });
  report.normal = fill([&](const Station& s, const Jet& jet) {
    return (s.p - jet.p).dot(outward_normal(report.shell, jet.p));
  });
  report.lateral = fill([&](const Station& s, const Jet& jet) {
    return (s.p - jet.p).dot(outward_normal(report.shell, jet.p).cross(jet.d1.normalized()));
  });
  for (const Station& s : stations_.first(count_)) {
    const Eigen::Vector3d off = at(s.t_rad).p - s.p;
    report.rms_mm += off.cwiseProduct(off) / n;
    spread += (s.p - centre_).cwiseProduct(s.p - centre_) / n;
  }
  report.r_squared = Eigen::Vector3d::Ones() - report.rms_mm.cwiseQuotient(spread);
  report.rms_mm = report.rms_mm.cwiseSqrt();
}

// A point speaks for as much of the curve as lies between two on average.
void ClosedCurveFit::mark_seen() noexcept {
  auto& seen = work_[0].seen;
  seen.fill(false);
  const double share = kSpacingsPerBin / static_cast<double>(std::max<std::size_t>(1, count_));
  const auto reach = static_cast<std::size_t>(std::ceil(0.5 * share * double{kSteps}));
  for (const Station& s : stations_.first(count_)) {
    if (s.used) {
      const double turn = s.t_rad / kTurnRad;
      const auto middle = static_cast<std::size_t>((turn - std::floor(turn)) * double{kSteps});
      for (std::size_t i = 0; i <= 2 * reach; ++i) {
        seen[(middle + kSteps - reach + i) % kSteps] = true;
      }
    }
  }
}

// Width of the stretch without a point around a step; 0 where there is one.
double ClosedCurveFit::hole_at(std::size_t step) const noexcept {
  const auto& seen = work_[0].seen;
  std::size_t ahead = 0;
  while (ahead < kSteps && !seen[(step + ahead) % kSteps]) {
    ++ahead;
  }
  std::size_t behind = 0;
  while (ahead > 0 && behind < kSteps && !seen[(step + kSteps - 1 - behind) % kSteps]) {
    ++behind;
  }
  return kTurnRad * static_cast<double>(ahead + behind) / double{kSteps};
}

void ClosedCurveFit::write_curve(double spacing_mm, Report& report,
                                 Buffer<SeamPoint>& out) noexcept {
  auto& lengths = work_[0].lengths;
  const auto t_of = [](double step) { return kTurnRad * step / double{kSteps}; };
  lengths[0] = 0.0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double middle = at(t_of(static_cast<double>(i) + 0.5)).d1.norm();
    const double ends = at(t_of(static_cast<double>(i))).d1.norm() +
                        at(t_of(static_cast<double>(i) + 1.0)).d1.norm();
    lengths[i + 1] = lengths[i] + t_of(1.0) * (4.0 * middle + ends) / 6.0;  // Simpson.
  }
  report.length_mm = lengths[kSteps];
  mark_seen();
  const double count = std::max(16.0, std::round(report.length_mm / spacing_mm));
  report.refusal = count <= static_cast<double>(out.capacity()) ? Refusal::kNone : Refusal::kFull;
  // Against the turn when the parameter runs clockwise about the nozzle.
  const double sense = up_.dot(report.nozzle.axis) > 0.0 ? 1.0 : -1.0;
  const double share = static_cast<double>(kCoefficients) / static_cast<double>(count_);
  for (double i = 0.0; report.refusal == Refusal::kNone && i < count; i += 1.0) {
    const double s = report.length_mm * i / count;
    const double along = sense > 0.0 ? s : std::fmod(report.length_mm - s, report.length_mm);
    const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, along);
    const auto k = static_cast<std::size_t>(after - lengths.begin()) - 1;
    const double part = (along - lengths[k]) / (lengths[k + 1] - lengths[k]);
    const Jet jet = at(t_of(static_cast<double>(k) + part));
    SeamPoint point;
    point.s_mm = s;
    point.p_base = jet.p;
    point.tangent = sense * jet.d1.normalized();
    point.n_shell = outward_normal(report.shell, jet.p);
    point.n_nozzle = outward_normal(report.nozzle, jet.p);
    point.dihedral_rad =
        std::numbers::pi - std::acos(std::clamp(point.n_shell.dot(point.n_nozzle), -1.0, 1.0));
    point.sigma_lateral_mm = report.lateral.rms_mm * std::sqrt(share);
    point.sigma_normal_mm = report.normal.rms_mm * std::sqrt(share);
    const double hole = hole_at(k);
    point.source = hole > 0.0 ? Source::kInterpolated : Source::kMeasured;
    point.confidence = confidence_of(point, hole);
    (void)out.append(point);
  }
}

}  // namespace dseam::seam
