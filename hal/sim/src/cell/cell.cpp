// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/cell.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "cell/random.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;

/// The camera at `eye` that looks at `aim`, its image's x axis level.
RigidTransform looking_at(const Vector3d& eye, const Vector3d& aim) {
  const Vector3d z = (aim - eye).normalized();
  const bool straight_down = std::abs(z.z()) > 1.0 - 1e-9;
  const Vector3d x = (straight_down ? Vector3d::UnitX() : z.cross(Vector3d::UnitZ())).normalized();
  RigidTransform T_part_camera;
  T_part_camera.rotation << x, z.cross(x), z;
  T_part_camera.translation_mm = eye;
  return T_part_camera;
}

/// Moved by normal errors, the rotation about the camera's own origin.
RigidTransform disturbed(RigidTransform T_base_camera, double sigma_mm, double sigma_rad,
                         Pcg32& random) {
  const auto draw = [&random](double sigma) {
    const double x = normal(random);
    const double y = normal(random);
    return Vector3d(sigma * Vector3d(x, y, normal(random)));
  };
  T_base_camera.translation_mm += draw(sigma_mm);
  T_base_camera.rotation = geometry::rotation_exp(draw(sigma_rad)) * T_base_camera.rotation;
  return T_base_camera;
}

Vector3d centre_of(const std::optional<TruthCurve>& seam) {
  Vector3d sum = Vector3d::Zero();
  if (!seam) {
    return sum;
  }
  for (const TruthPoint& point : seam->points) {
    sum += point.p;
  }
  return sum / static_cast<double>(seam->points.size());
}

std::vector<CellView> plan_views(const CellConfig& config, const Vector3d& seam_centre) {
  const ViewConfig& plan = config.views;
  const Vector3d aim = seam_centre + Vector3d(plan.aim_x_mm, 0.0, plan.aim_above_mm);
  const bool full_turn = plan.azimuth_span_rad > 2.0 * std::numbers::pi - 1e-6;
  const double steps = full_turn ? plan.count : std::max(1.0, plan.count - 1.0);
  Pcg32 poses = stream(config.seed, Stream::kPoses);
  Pcg32 reports = stream(config.seed, Stream::kReports);
  std::vector<CellView> views;
  for (std::uint32_t i = 0; i < plan.count; ++i) {
    const double azimuth = plan.first_azimuth_rad + plan.azimuth_span_rad * i / steps;
    const Vector3d outwards(std::sin(plan.tilt_rad) * std::cos(azimuth),
                            std::sin(plan.tilt_rad) * std::sin(azimuth), std::cos(plan.tilt_rad));
    const RigidTransform planned = looking_at(aim + plan.working_distance_mm * outwards, aim);
    CellView view;
    view.T_base_camera =
        disturbed(config.T_base_part * planned, plan.jitter_mm, plan.jitter_rad, poses);
    view.T_base_camera_reported =
        disturbed(view.T_base_camera, plan.pose_error_mm, plan.pose_error_rad, reports);
    views.push_back(view);
  }
  return views;
}

Blind blind_of(const ScannerConfig& scanner, const std::optional<TruthCurve>& seam) {
  Blind blind;
  if (seam) {
    blind.joint_part = *seam;
    blind.dead_band_mm = scanner.dead_band_mm;
    blind.unseen_from_mm = scanner.unseen_start * seam->length_mm;
    blind.unseen_length_mm = scanner.unseen_share * seam->length_mm;
    blind.unseen_reach_mm = scanner.unseen_reach_mm;
  }
  return blind;
}

}  // namespace

Result<Cell> Cell::make(const CellConfig& config) {
  if (fault_in(config) != nullptr) {
    return Errc::kInvalidArgument;
  }
  return Cell(config);
}

Cell::Cell(const CellConfig& config) : config_(config), scene_(make_scene(config)) {
  const auto seam = truth_curve(config.joint, seam::ReferenceCurve::kShellEdge);
  blind_ = blind_of(config.scanner, seam);
  views_ = plan_views(config, centre_of(seam));
  for (const Vector3d& marker : scene_.markers) {
    markers_.push_back(config.T_base_part * marker);
  }
}

std::optional<TruthCurve> Cell::seam(seam::ReferenceCurve reference) const {
  auto curve = truth_curve(config_.joint, reference);
  return curve ? std::optional(transformed(config_.T_base_part, *std::move(curve))) : std::nullopt;
}

void Cell::scan(std::size_t i, Rendering& out) const {
  const RigidTransform T_part_camera = config_.T_base_part.inverse() * views_[i].T_base_camera;
  const std::uint64_t seed = config_.seed * 1009 + i;
  render(scene_, blind_, config_, T_part_camera, seed, out);
}

}  // namespace dseam::hal::sim
