// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace dseam::seam {
namespace {

constexpr double kNearMm = 6.0;
constexpr double kMinGapMm = 0.25;
constexpr double kHighSigmaMm = 0.1;
constexpr double kMediumSigmaMm = 0.3;
constexpr double kLowSigmaMm = 1.0;
constexpr double kSmallHoleRad = 10.0 * std::numbers::pi / 180.0;

double offset_of_axes(const Surface& nozzle, const Surface& shell) noexcept {
  const Eigen::Vector3d between = shell.point - nozzle.point;
  const Eigen::Vector3d common = nozzle.axis.cross(shell.axis);
  if (shell.kind == SurfaceKind::kPlane) {
    return 0.0;
  }
  if (shell.kind == SurfaceKind::kSphere || common.norm() < 1e-6) {
    return between.cross(nozzle.axis).norm();
  }
  return std::abs(between.dot(common.normalized()));
}

ResidualStats stats_of(const JointFit& fit, const JointFit::Side& side, bool shell,
                       std::span<float> scratch) noexcept {
  ResidualStats stats;
  double squares = 0.0;
  for (const NearPoint& q : side.points.view()) {
    if (!q.trusted || q.away_mm > kNearMm || stats.count >= scratch.size()) {
      continue;
    }
    const Eigen::Vector3d p = fit.pivot() + q.from_pivot.cast<double>();
    const double rest = std::abs(shell ? fit.above_shell(p) : fit.outside_nozzle(p));
    scratch[stats.count++] = static_cast<float>(rest);
    squares += rest * rest;
    stats.max_mm = std::max(stats.max_mm, rest);
  }
  if (stats.count > 0) {
    const auto place = scratch.begin() + static_cast<std::ptrdiff_t>(stats.count * 95 / 100);
    std::nth_element(scratch.begin(), place,
                     scratch.begin() + static_cast<std::ptrdiff_t>(stats.count));
    stats.p95_mm = double{*place};
    stats.rms_mm = std::sqrt(squares / stats.count);
  }
  return stats;
}

struct Width {
  double mean_mm = 0.0;
  double max_mm = 0.0;
};

Width width_of(const EdgeCurve& edge) noexcept {
  constexpr int kAngles = 72;
  Width width;
  for (int i = 0; i < kAngles; ++i) {
    const double at = edge.at(2.0 * std::numbers::pi * i / kAngles);
    width.mean_mm += at / kAngles;
    width.max_mm = std::max(width.max_mm, at);
  }
  return width;
}

}  // namespace

Confidence confidence_of(const SeamPoint& point, double hole_rad) noexcept {
  const double sigma = std::max(point.sigma_lateral_mm, point.sigma_normal_mm);
  const bool measured = point.source == Source::kMeasured;
  if (measured && sigma <= kHighSigmaMm) {
    return Confidence::kHigh;
  }
  if ((measured && sigma <= kMediumSigmaMm) ||
      (hole_rad <= kSmallHoleRad && sigma <= kHighSigmaMm)) {
    return Confidence::kMedium;
  }
  return sigma <= kLowSigmaMm ? Confidence::kLow : Confidence::kNone;
}

void describe_joint(const JointFit& fit, JointReport& report) noexcept {
  report.shell = fit.joint().shell;
  report.nozzle = fit.joint().nozzle;
  const double cosine = std::abs(report.shell.axis.dot(report.nozzle.axis));
  report.axes_angle_rad =
      report.shell.kind == SurfaceKind::kSphere ? 0.0 : std::acos(std::min(1.0, cosine));
  report.axes_offset_mm = offset_of_axes(report.nozzle, report.shell);
  report.shell_harmonics = std::max(0, fit.shell().residual.harmonics());
  report.nozzle_harmonics = std::max(0, fit.nozzle().residual.harmonics());
  report.num_shell_points = static_cast<std::uint32_t>(fit.shell().points.size());
  report.num_nozzle_points = static_cast<std::uint32_t>(fit.nozzle().points.size());
}

bool describe_gap(const EdgeCurve& edge, JointReport& report) noexcept {
  const Width width = width_of(edge);
  report.mean_gap_mm = width.mean_mm;
  report.max_gap_mm = width.max_mm;
  report.has_gap = width.mean_mm > kMinGapMm;
  return report.has_gap;
}

bool describe_mismatch(const EdgeCurve& edge, JointReport& report) noexcept {
  const Width width = width_of(edge);
  report.has_nozzle_edge = width.mean_mm > kMinGapMm;
  report.mean_mismatch_mm = report.has_nozzle_edge ? width.mean_mm : 0.0;
  report.max_mismatch_mm = report.has_nozzle_edge ? width.max_mm : 0.0;
  return report.has_nozzle_edge;
}

void describe_residuals(const JointFit& fit, std::span<float> scratch,
                        SeamQuality& quality) noexcept {
  quality.normal = stats_of(fit, fit.shell(), true, scratch);
  quality.lateral = stats_of(fit, fit.nozzle(), false, scratch);
}

void describe_widths(std::span<const SeamPoint> points, JointReport& report) noexcept {
  const double n = std::max(1.0, static_cast<double>(points.size()));
  for (const SeamPoint& point : points) {
    report.mean_gap_mm += point.gap_mm / n;
    report.max_gap_mm = std::max(report.max_gap_mm, point.gap_mm);
    report.mean_mismatch_mm += point.mismatch_mm / n;
    report.max_mismatch_mm = std::max(report.max_mismatch_mm, point.mismatch_mm);
  }
  report.has_gap = report.mean_gap_mm > kMinGapMm;
  report.has_nozzle_edge = report.mean_mismatch_mm > kMinGapMm;
}

void describe_curve(std::span<const SeamPoint> points, SeamReport& report) noexcept {
  SeamQuality& q = report.quality;
  q.num_by_confidence = {};
  double measured = 0.0;
  for (const SeamPoint& point : points) {
    ++q.num_by_confidence[static_cast<std::uint8_t>(point.confidence)];
    if (point.source != Source::kMeasured) {
      continue;
    }
    measured += 1.0;
    q.mean_sigma_lateral_mm += point.sigma_lateral_mm;
    q.mean_sigma_normal_mm += point.sigma_normal_mm;
    q.max_sigma_lateral_mm = std::max(q.max_sigma_lateral_mm, point.sigma_lateral_mm);
    q.max_sigma_normal_mm = std::max(q.max_sigma_normal_mm, point.sigma_normal_mm);
  }
  q.coverage = points.empty() ? 0.0 : measured / static_cast<double>(points.size());
  q.mean_sigma_lateral_mm /= std::max(1.0, measured);
  q.mean_sigma_normal_mm /= std::max(1.0, measured);
}

Refusal verdict_of(const SeamReport& report, const QualityLimits& limits) noexcept {
  const SeamQuality& q = report.quality;
  if (!(q.coverage >= limits.min_coverage)) {
    return Refusal::kLowCoverage;
  }
  if (!(q.largest_hole_rad <= limits.max_hole_rad)) {
    return Refusal::kLargeHole;
  }
  const double sigma = std::max(q.max_sigma_lateral_mm, q.max_sigma_normal_mm);
  return sigma <= limits.max_sigma_mm ? Refusal::kNone : Refusal::kUncertain;
}

}  // namespace dseam::seam
