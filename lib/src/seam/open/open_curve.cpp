// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/open_curve.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/seam/curve/quality.hpp"

namespace dseam::seam {
namespace {

constexpr int kNewtonSteps = 8;
constexpr double kPlacedMm = 1e-7;
constexpr double kGoodEnoughMm = 1e-3;
constexpr double kMaxStepMm = 50.0;
constexpr double kTangentStepMm = 0.1;
constexpr double kEdgeBiasMm = 0.1;  // Of an edge that single points of a cloud show.

}  // namespace

bool OpenCurve::has(ReferenceCurve reference, const OpenJoint& joint,
                    const OpenSides& sides) noexcept {
  const bool butt = joint.kind == OpenKind::kButt;
  const bool on_edge =
      reference == ReferenceCurve::kNozzleEdge || reference == ReferenceCurve::kGapMiddle;
  return butt || !on_edge || sides.side(1).edge.fitted();
}

OpenCurve::Report OpenCurve::run(const Config& config, const OpenJoint& joint,
                                 const SeamTrack& track, const OpenSides& sides,
                                 const ErrorSources& errors, Buffer<SeamPoint>& out) noexcept {
  config_ = config;
  joint_ = &joint;
  track_ = &track;
  sides_ = &sides;
  out.clear();
  Report report;
  const SeamTrack::Station middle = track.at(0.5 * (sides.start_mm() + sides.end_mm()));
  const Eigen::Vector3d left = joint.normal(0, middle.p).cross(middle.tangent);
  const Eigen::Vector3d second = joint.kind == OpenKind::kButt
                                     ? Eigen::Vector3d(joint.seam_sign[1] * joint.across)
                                     : joint.normal(0, middle.p);
  const Eigen::Vector3d towards =
      joint.kind == OpenKind::kButt ? second : Eigen::Vector3d(-joint.normal(1, middle.p));
  forward_ = (left.dot(towards) > 0.0) == config.second_side_left;
  report.forward = forward_;
  report.length_mm = sides.end_mm() - sides.start_mm();
  const double steps = std::max(4.0, std::round(report.length_mm / config.point_spacing_mm));
  if (!(steps + 1.0 <= static_cast<double>(out.capacity()))) {
    report.full = true;
    return report;
  }
  for (double i = 0.0; i <= steps; i += 1.0) {
    const double travelled = report.length_mm * i / steps;
    if (!place(s_at(travelled))) {
      return report;
    }
    (void)out.append(point_at(travelled, errors));
  }
  report.placed = true;
  return report;
}

double OpenCurve::s_at(double travelled_mm) const noexcept {
  return forward_ ? sides_->start_mm() + travelled_mm : sides_->end_mm() - travelled_mm;
}

// Newton on: on the first side but for what the second stands above it, on the second, at s.
std::optional<Eigen::Vector3d> OpenCurve::meet(double s_mm, double raised_mm) const noexcept {
  const SeamTrack::Station at = track_->at(s_mm);
  const double along = sides_->along_of(s_mm);
  const double first = sides_->side(0).deviation.at(along) + raised_mm;
  const double second = sides_->side(1).deviation.at(along);
  Eigen::Vector3d p = at.p;
  double last = 0.0;
  for (int i = 0; i < kNewtonSteps; ++i) {
    Eigen::Matrix3d slopes;
    slopes.row(0) = joint_->normal(0, p);
    slopes.row(1) = joint_->normal(1, p);
    slopes.row(2) = at.tangent;
    const Eigen::Vector3d miss(joint_->off(0, p) - first, joint_->off(1, p) - second,
                               at.tangent.dot(p - at.p));
    const Eigen::Vector3d step = slopes.inverse() * miss;
    if (!(step.norm() < kMaxStepMm)) {
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

// On a plate's edge beside the gap, at the plate's own height.
Eigen::Vector3d OpenCurve::edge_of(std::size_t side, double s_mm) const noexcept {
  const SeamTrack::Station at = track_->at(s_mm);
  const double along = sides_->along_of(s_mm);
  const double away = sides_->side(side).edge.at(along);
  const double now = joint_->across.dot(at.p - joint_->middle);
  Eigen::Vector3d p = at.p + (joint_->seam_sign[side] * away - now) * joint_->across;
  const double height = joint_->off(side, p) - sides_->side(side).deviation.at(along);
  p -= height * joint_->normal(side, p);
  return p;
}

std::optional<Eigen::Vector3d> OpenCurve::place(double s_mm) const noexcept {
  if (joint_->kind == OpenKind::kButt) {
    switch (config_.reference) {
      case ReferenceCurve::kShellEdge:
        return edge_of(0, s_mm);
      case ReferenceCurve::kNozzleEdge:
        return edge_of(1, s_mm);
      default:
        return 0.5 * (edge_of(0, s_mm) + edge_of(1, s_mm));
    }
  }
  const double raised =
      sides_->side(1).edge.fitted() ? sides_->side(1).edge.at(sides_->along_of(s_mm)) : 0.0;
  const double share = config_.reference == ReferenceCurve::kNozzleEdge  ? 1.0
                       : config_.reference == ReferenceCurve::kGapMiddle ? 0.5
                                                                         : 0.0;
  return meet(s_mm, share * raised);
}

void OpenCurve::describe_opening(SeamPoint& point, double s_mm) const noexcept {
  const double along = sides_->along_of(s_mm);
  if (joint_->kind == OpenKind::kButt) {
    const Eigen::Vector3d between = edge_of(1, s_mm) - edge_of(0, s_mm);
    point.gap_mm = std::max(0.0, joint_->seam_sign[1] * between.dot(joint_->across));
    point.mismatch_mm = std::abs(between.dot(point.n_shell));
  } else if (sides_->side(1).edge.fitted()) {
    point.mismatch_mm = std::max(0.0, sides_->side(1).edge.at(along));
  }
}

void OpenCurve::estimate_errors(SeamPoint& point, double s_mm,
                                const ErrorSources& errors) const noexcept {
  const double along = sides_->along_of(s_mm);
  const double common =
      errors.pose_sigma_mm * errors.pose_sigma_mm + errors.depth_sigma_mm * errors.depth_sigma_mm;
  const double hand_eye = errors.hand_eye_sigma_mm * errors.hand_eye_sigma_mm;
  const auto& first = sides_->side(0);
  const auto& second = sides_->side(1);
  const double bias = kEdgeBiasMm * kEdgeBiasMm;
  const bool middle =
      config_.reference == ReferenceCurve::kRoot || config_.reference == ReferenceCurve::kGapMiddle;
  double normal = first.deviation.variance_at(along) + common;
  double lateral = second.deviation.variance_at(along) + common;
  if (joint_->kind == OpenKind::kButt) {
    const double edges = first.edge.variance_at(along) + second.edge.variance_at(along);
    const auto& side = config_.reference == ReferenceCurve::kNozzleEdge ? second : first;
    lateral = (middle ? 0.25 * edges : side.edge.variance_at(along) + bias) + common;
  } else {
    const bool raised = config_.reference == ReferenceCurve::kNozzleEdge ||
                        config_.reference == ReferenceCurve::kGapMiddle;
    normal += raised ? second.edge.variance_at(along) + bias : 0.0;
    const double cosine = point.n_shell.dot(point.n_nozzle);
    lateral = (lateral + cosine * cosine * normal) / std::max(1e-3, 1.0 - cosine * cosine);
  }
  point.sigma_lateral_mm = std::sqrt(lateral + hand_eye);
  point.sigma_normal_mm = std::sqrt(normal + hand_eye);
}

SeamPoint OpenCurve::point_at(double travelled_mm, const ErrorSources& errors) const noexcept {
  const double s = s_at(travelled_mm);
  const Eigen::Vector3d p = *place(s);
  SeamPoint point;
  point.s_mm = travelled_mm;
  point.p_base = p;
  const Eigen::Vector3d ahead = place(s + kTangentStepMm).value_or(p);
  const Eigen::Vector3d behind = place(s - kTangentStepMm).value_or(p);
  point.tangent = (forward_ ? 1.0 : -1.0) * (ahead - behind).normalized();
  const auto across_tangent = [&](const Eigen::Vector3d& n) -> Eigen::Vector3d {
    return (n - n.dot(point.tangent) * point.tangent).normalized();
  };
  point.n_shell = across_tangent(joint_->normal(0, p));
  point.n_nozzle = across_tangent(joint_->normal(1, p));
  point.dihedral_rad =
      std::numbers::pi - std::acos(std::clamp(point.n_shell.dot(point.n_nozzle), -1.0, 1.0));
  describe_opening(point, s);
  point.source = sides_->measured_at(s) ? Source::kMeasured : Source::kInterpolated;
  estimate_errors(point, s, errors);
  point.confidence = confidence_of(point, std::numbers::pi);
  return point;
}

}  // namespace dseam::seam
