// SPDX-License-Identifier: Apache-2.0
#include "shape/joint_geometry.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

/// The surface's equation is |w|^2 = 1 with w = scale * (p - centre); a cylinder's scale is 0 in x.
Vector3d scale_of(const ShellSurface& shell) {
  const double along = shell.kind == ShellKind::kSphere ? 1.0 / shell.half_y : 0.0;
  return {along, 1.0 / shell.half_y, 1.0 / shell.half_z};
}

}  // namespace

ShellSurface ShellSurface::grown(double offset_mm) const noexcept {
  ShellSurface out = *this;
  if (kind == ShellKind::kPlane) {
    out.centre_z += offset_mm;
  } else {
    out.half_y += offset_mm;
    out.half_z += offset_mm;
  }
  return out;
}

std::optional<double> ShellSurface::meet(const Ray& line) const noexcept {
  if (kind == ShellKind::kPlane) {
    return (centre_z - line.origin.z()) / line.direction.z();
  }
  const Vector3d scale = scale_of(*this);
  const Vector3d o = scale.cwiseProduct(line.origin - Vector3d(0.0, 0.0, centre_z));
  const Vector3d d = scale.cwiseProduct(line.direction);
  const double a = d.squaredNorm();
  const double b = o.dot(d);
  const double discriminant = b * b - a * (o.squaredNorm() - 1.0);
  if (!(discriminant > 0.0)) {
    return std::nullopt;
  }
  return (-b + std::sqrt(discriminant)) / a;
}

Vector3d ShellSurface::normal(const Vector3d& p) const noexcept {
  if (kind == ShellKind::kPlane) {
    return Vector3d::UnitZ();
  }
  const Vector3d scale = scale_of(*this);
  const Vector3d from_centre = p - Vector3d(0.0, 0.0, centre_z);
  return scale.cwiseProduct(scale).cwiseProduct(from_centre).normalized();
}

Ray Lateral::ruling(double phi_rad) const noexcept {
  const double x = a * std::cos(phi_rad);
  const double y = b * std::sin(phi_rad);
  return {centre + axes * Vector3d(x, y, 0.0), axes * Vector3d(taper * x, taper * y, 1.0)};
}

Vector3d Lateral::normal(const Vector3d& p) const noexcept {
  const Vector3d local = axes.transpose() * (p - centre);
  const Vector3d gradient(local.x() / (a * a), local.y() / (b * b),
                          -taper * (1.0 + taper * local.z()));
  return (axes * gradient).normalized();
}

ShellSurface shell_surface(const JointConfig& joint) noexcept {
  const double r = joint.shell_radius_mm;
  switch (joint.shell) {
    case ShellKind::kPlane:
      return {joint.shell, 0.0, 0.0, 0.0};
    case ShellKind::kSphere:
      return {joint.shell, r, r, -r};
    case ShellKind::kCylinder:
      break;
  }
  const double o = joint.shell_ovality_mm;
  return {joint.shell, r + o, r - o, -(r - o)};
}

Lateral nozzle_side(const JointConfig& joint) noexcept {
  const double lean = joint.axis_angle_rad;
  const Vector3d z(std::cos(lean), 0.0, std::sin(lean));
  const Vector3d x(std::sin(lean), 0.0, -std::cos(lean));
  Eigen::Matrix3d axes;
  axes << x, Vector3d::UnitY(), z;
  const Eigen::AngleAxisd turn(joint.nozzle_ovality_angle_rad, Vector3d::UnitZ());
  return {Vector3d(0.0, joint.eccentricity_mm, 0.0), axes * turn.toRotationMatrix(),
          joint.nozzle_radius_mm + joint.nozzle_ovality_mm,
          joint.nozzle_radius_mm - joint.nozzle_ovality_mm,
          -std::tan(joint.nozzle_taper_rad) / joint.nozzle_radius_mm};
}

Lateral hole_side(const JointConfig& joint) noexcept {
  Lateral hole = nozzle_side(joint);
  hole.centre += Vector3d(joint.hole_shift_x_mm, joint.hole_shift_y_mm, 0.0);
  hole.a += joint.gap_mm;
  hole.b += joint.gap_mm;
  return hole;
}

std::optional<Vector3d> joint_point(const Lateral& side, const ShellSurface& shell,
                                    double phi_rad) noexcept {
  const Ray line = side.ruling(phi_rad);
  const std::optional<double> along = shell.meet(line);
  if (!along) {
    return std::nullopt;
  }
  return line.origin + *along * line.direction;
}

}  // namespace dseam::hal::sim
