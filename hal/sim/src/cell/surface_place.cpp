// SPDX-License-Identifier: Apache-2.0
#include "cell/surface_place.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

Place facing(const Vector3d& p, const Vector3d& z, const Vector3d& towards) {
  Place place;
  place.p = p;
  const Vector3d y = z.cross(towards).normalized();
  place.axes << y.cross(z), y, z;
  return place;
}

/// Open joints lie on the x axis: phi runs over its length instead of round it.
Vector3d along_open_joint(const JointConfig& joint, double phi_rad) {
  return {0.4 * joint.shell_length_mm * std::cos(phi_rad), 0.0, 0.0};
}

}  // namespace

PlaceFinder::PlaceFinder(const JointConfig& joint)
    : joint_(joint),
      shell_(shell_surface(joint)),
      side_(nozzle_side(joint)),
      hole_(hole_side(joint)) {
  if (joint.kind == JointKind::kTFillet || joint.kind == JointKind::kButt) {
    shell_ = {ShellKind::kPlane, 0.0, 0.0, 0.0};
  }
}

std::optional<Place> PlaceFinder::outside_joint(double phi_rad, double distance_mm) const {
  constexpr double kFromEdge = 8.0;
  constexpr double kFlattest = 0.5;  // Cosine of the steepest slope that is still used.
  const bool open = joint_.kind == JointKind::kTFillet || joint_.kind == JointKind::kButt;
  const auto start = open ? along_open_joint(joint_, phi_rad) : joint_point(hole_, shell_, phi_rad);
  if (!start) {
    return std::nullopt;
  }
  const double turn = phi_rad + joint_.nozzle_ovality_angle_rad;  // phi starts at the longer axis.
  Vector3d away = open ? Vector3d::UnitY() : Vector3d(std::cos(turn), std::sin(turn), 0.0);
  if (joint_.kind == JointKind::kButt && std::sin(phi_rad) < 0.0) {
    away = -away;
  }
  const Vector3d over = *start + distance_mm * away;
  const double half_length = 0.5 * joint_.shell_length_mm - kFromEdge;
  const bool beside = joint_.shell != ShellKind::kSphere && std::abs(over.x()) > half_length;
  const auto height = shell_.meet({Vector3d(over.x(), over.y(), 0.0), Vector3d::UnitZ()});
  if (beside || !height) {
    return std::nullopt;
  }
  const Vector3d p(over.x(), over.y(), *height);
  const Vector3d normal = shell_.normal(p);
  const bool off_plate = shell_.kind == ShellKind::kPlane && std::abs(p.y()) > half_length;
  if (off_plate || normal.z() < kFlattest) {
    return std::nullopt;
  }
  return facing(p, normal, away);
}

std::optional<Place> PlaceFinder::on_nozzle(double phi_rad, double height_mm) const {
  const auto foot = is_closed(joint_.kind) ? joint_point(side_, shell_, phi_rad) : std::nullopt;
  if (!foot) {
    return std::nullopt;
  }
  const Vector3d p = *foot + height_mm * side_.ruling(phi_rad).direction;
  return facing(p, side_.normal(p), Vector3d::UnitZ());
}

std::optional<Place> PlaceFinder::on_joint(double phi_rad) const {
  if (!is_closed(joint_.kind)) {
    return Place{along_open_joint(joint_, phi_rad), Eigen::Matrix3d::Identity()};
  }
  const auto p = joint_point(side_, shell_, phi_rad);
  if (!p) {
    return std::nullopt;
  }
  return facing(*p, shell_.normal(*p), side_.normal(*p));
}

}  // namespace dseam::hal::sim
