// SPDX-License-Identifier: Apache-2.0
// The torch over one point of the joint, and whether it may weld there.
#include <algorithm>
#include <cmath>

#include "dseam/torch/torch_planner.hpp"

namespace dseam::torch {
namespace {

using Eigen::Vector3d;

constexpr double kMinNormal = 0.1;  // A smoothed normal shorter than this points nowhere.
constexpr double kMinOpening =
    0.05;  // rad; flatter or sharper joints have no bisector to speak of.

bool in(double v, double low, double high) noexcept { return v >= low && v <= high; }

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
  if (nearest.confidence < config_.min_confidence) {
    return Weldable::kLowConfidence;
  }
  if (!(std::max(nearest.gap_mm, nearest.mismatch_mm) <= config_.max_gap_mm)) {
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
