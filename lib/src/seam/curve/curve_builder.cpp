// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/curve_builder.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/curve/quality.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr int kNewtonSteps =
    30;  // The deviations' own slope is left out: it converges by a share a step.
constexpr double kPlacedMm = 1e-7;
constexpr double kGoodEnoughMm = 1e-3;
constexpr double kStepRad = 2e-3;  // Of the central difference that gives the tangent.

}  // namespace

CurveBuilder::Report CurveBuilder::run(const Config& config, const JointFit& fit,
                                       const JointEdges& edges, const RingCoverage& coverage,
                                       const ErrorSources& sources,
                                       Buffer<SeamPoint>& out) noexcept {
  config_ = config;
  fit_ = &fit;
  edges_ = edges;
  Report report;
  out.clear();
  if (!measure_length()) {
    return report;
  }
  report.length_mm = lengths_[kStations];
  prepare_errors(sources);
  const double count = std::max(16.0, std::round(report.length_mm / config.point_spacing_mm));
  if (!(count <= static_cast<double>(out.capacity()))) {
    report.full = true;
    return report;
  }
  for (double i = 0.0; i < count; i += 1.0) {
    (void)out.append(point_at(report.length_mm * i / count, coverage));
  }
  const auto again = place(angle_of(kTurnRad), stations_[0]);
  report.closure_mm = again ? (*again - out[0].p_base).norm() : report.length_mm;
  report.placed = true;
  return report;
}

double CurveBuilder::angle_of(double turn_rad) const noexcept {
  return config_.start_angle_rad + (config_.counter_clockwise ? turn_rad : -turn_rad);
}

// The edge on which the reference curve rests; nullptr where it rests on the surfaces alone.
const EdgeCurve* CurveBuilder::edge_in_use() const noexcept {
  switch (config_.reference) {
    case ReferenceCurve::kRoot:
      return nullptr;
    case ReferenceCurve::kShellEdge:
      return edges_.shell;
    case ReferenceCurve::kNozzleEdge:
      return edges_.nozzle;
    case ReferenceCurve::kGapMiddle:
      return edges_.shell != nullptr ? edges_.shell : edges_.nozzle;
  }
  return nullptr;
}

double CurveBuilder::offset_at(double phi_rad) const noexcept {
  const bool aside = edges_.shell != nullptr && edge_in_use() == edges_.shell;
  const double share = config_.reference == ReferenceCurve::kGapMiddle ? 0.5 : 1.0;
  return aside ? share * edges_.shell->at(phi_rad) : 0.0;
}

double CurveBuilder::height_at(double phi_rad) const noexcept {
  const bool raised = edges_.nozzle != nullptr && edge_in_use() == edges_.nozzle;
  const double share = config_.reference == ReferenceCurve::kGapMiddle ? 0.5 : 1.0;
  return raised ? share * edges_.nozzle->at(phi_rad) : 0.0;
}

// Newton on: off shell and nozzle by what the edge is, at the angle.
std::optional<Eigen::Vector3d> CurveBuilder::place(double phi_rad,
                                                   const Eigen::Vector3d& guess) const noexcept {
  const Joint& joint = fit_->joint();
  const NozzleFrame& frame = fit_->frame();
  const Eigen::Vector3d aside = std::cos(phi_rad) * frame.v - std::sin(phi_rad) * frame.u;
  const double offset = offset_at(phi_rad);
  const double height = height_at(phi_rad);
  Eigen::Vector3d p = guess;
  double last = 0.0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    Eigen::Matrix3d slopes;
    slopes.row(0) = shell_normal(joint, p);
    slopes.row(1) = outward_normal(joint.nozzle, p);
    slopes.row(2) = aside;
    const Eigen::Vector3d miss(fit_->above_shell(p) - height, fit_->outside_nozzle(p) - offset,
                               aside.dot(p - joint.nozzle.point));
    const Eigen::Vector3d step = slopes.inverse() * miss;
    if (!(step.norm() < joint.nozzle.radius_mm)) {
      return std::nullopt;
    }
    p -= step;
    last = step.norm();
    if (last < kPlacedMm) {
      return p;
    }
  }
  return last < kGoodEnoughMm ? std::optional(p) : std::nullopt;
}

// Whether the reference curve rests on edges seen nearby, where it needs them.
bool CurveBuilder::held_at(double phi_rad) const noexcept {
  return edge_in_use() == nullptr || edge_in_use()->held_at(phi_rad);
}

bool CurveBuilder::measure_length() noexcept {
  const Joint& joint = fit_->joint();
  for (std::size_t i = 0; i < kStations; ++i) {
    const double phi = angle_of(kTurnRad * static_cast<double>(i) / double{kStations});
    const auto root = root_at(joint, fit_->frame(), phi);
    const auto placed = root ? place(phi, *root) : std::nullopt;
    if (!placed) {
      return false;
    }
    stations_[i] = *placed;
  }
  lengths_[0] = 0.0;
  for (std::size_t i = 0; i < kStations; ++i) {
    const auto at = [&](std::size_t k) -> const Eigen::Vector3d& {
      return stations_[k % kStations];
    };
    const double chord = (at(i + 1) - at(i)).norm();
    const double wide = (at(i + 2) - at(i + kStations - 1)).norm();
    // The arc over three steps sags by nine times the chord's: Richardson's extrapolation.
    const double arc = chord + (3.0 * chord - wide) / 24.0;
    lengths_[i + 1] = lengths_[i] + arc;
  }
  return true;
}

void CurveBuilder::prepare_errors(const ErrorSources& sources) noexcept {
  constexpr std::size_t kEvery = 16;
  const EdgeCurve* edge = edge_in_use();
  const bool aside = edge == edges_.shell;
  ErrorSources known = sources;
  known.hidden_gap_mm = config_.reference == ReferenceCurve::kRoot ? 0.0 : sources.hidden_gap_mm;
  errors_.reset(*fit_, {aside ? edge : nullptr, aside ? nullptr : edge}, known);
  for (std::size_t i = 0; i < kStations; i += kEvery) {
    errors_.add(angle_of(kTurnRad * static_cast<double>(i) / double{kStations}), stations_[i]);
  }
}

SeamPoint CurveBuilder::point_at(double s_mm, const RingCoverage& coverage) const noexcept {
  const auto after = std::upper_bound(lengths_.begin() + 1, lengths_.end() - 1, s_mm);
  const auto i = static_cast<std::size_t>(after - lengths_.begin()) - 1;
  const double part = (s_mm - lengths_[i]) / (lengths_[i + 1] - lengths_[i]);
  const double phi = angle_of(kTurnRad * (static_cast<double>(i) + part) / double{kStations});
  const Eigen::Vector3d guess =
      stations_[i] + part * (stations_[(i + 1) % kStations] - stations_[i]);
  const double step = config_.counter_clockwise ? kStepRad : -kStepRad;
  SeamPoint point;
  point.s_mm = s_mm;
  const std::optional<Eigen::Vector3d> placed = place(phi, guess);
  point.p_base = placed.value_or(guess);
  const Eigen::Vector3d ahead = place(phi + step, guess).value_or(guess);
  const Eigen::Vector3d behind = place(phi - step, guess).value_or(guess);
  point.tangent = (ahead - behind).normalized();
  const auto across_tangent = [&](const Eigen::Vector3d& n) -> Eigen::Vector3d {
    return (n - n.dot(point.tangent) * point.tangent).normalized();
  };
  point.n_shell = across_tangent(shell_normal(fit_->joint(), point.p_base));
  point.n_nozzle = across_tangent(outward_normal(fit_->joint().nozzle, point.p_base));
  point.dihedral_rad =
      std::numbers::pi - std::acos(std::clamp(point.n_shell.dot(point.n_nozzle), -1.0, 1.0));
  point.gap_mm = edges_.shell == nullptr ? 0.0 : std::max(0.0, edges_.shell->at(phi));
  point.mismatch_mm = edges_.nozzle == nullptr ? 0.0 : std::max(0.0, edges_.nozzle->at(phi));
  const bool measured = placed && coverage.measured_at(phi) && held_at(phi);
  point.source = measured ? Source::kMeasured : Source::kInterpolated;
  errors_.estimate(phi, point);
  point.confidence = placed ? confidence_of(point, coverage.hole_at(phi)) : Confidence::kNone;
  return point;
}

}  // namespace dseam::seam
