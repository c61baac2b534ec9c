// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/joint.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::seam {
namespace {

// The distances along a line at which it meets a surface, the lesser first.
struct Crossings {
  int count = 0;
  double first = 0.0;
  double second = 0.0;
};

Crossings roots(double a, double b, double c) noexcept {  // a x^2 + 2 b x + c
  if (std::abs(a) < 1e-12) {
    return std::abs(b) < 1e-12 ? Crossings{} : Crossings{1, -0.5 * c / b, 0.0};
  }
  const double under = b * b - a * c;
  if (!(under >= 0.0)) {
    return {};
  }
  const double q = -(b + std::copysign(std::sqrt(under), b));
  const double x = q / a;
  const double y = q != 0.0 ? c / q : x;
  return {2, std::min(x, y), std::max(x, y)};
}

Crossings crossings(const Surface& s, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction) noexcept {
  const Eigen::Vector3d q = origin - s.point;
  if (s.kind == SurfaceKind::kPlane) {
    return roots(0.0, 0.5 * s.axis.dot(direction), s.axis.dot(q));
  }
  if (s.kind == SurfaceKind::kSphere) {
    return roots(1.0, q.dot(direction), q.squaredNorm() - s.radius_mm * s.radius_mm);
  }
  const double dt = direction.dot(s.axis);
  const double t = q.dot(s.axis);
  const double radius = s.radius_mm + s.slope * t;
  const double growth = s.slope * dt;
  return roots(1.0 - dt * dt - growth * growth, q.dot(direction) - t * dt - radius * growth,
               q.squaredNorm() - t * t - radius * radius);
}

}  // namespace

double shell_distance(const Joint& joint, const Eigen::Vector3d& p) noexcept {
  return joint.shell_sign * signed_distance(joint.shell, p);
}

Eigen::Vector3d shell_normal(const Joint& joint, const Eigen::Vector3d& p) noexcept {
  return joint.shell_sign * outward_normal(joint.shell, p);
}

NozzleFrame frame_of(const Surface& nozzle) noexcept {
  const bool along_x = std::abs(nozzle.axis.x()) > 0.99;
  const Eigen::Vector3d zero = along_x ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d u = (zero - zero.dot(nozzle.axis) * nozzle.axis).normalized();
  return {u, nozzle.axis.cross(u)};
}

double angle_about(const Surface& nozzle, const NozzleFrame& frame,
                   const Eigen::Vector3d& p) noexcept {
  const Eigen::Vector3d q = p - nozzle.point;
  return std::atan2(q.dot(frame.v), q.dot(frame.u));
}

std::optional<Eigen::Vector3d> root_at(const Joint& joint, const NozzleFrame& frame,
                                       double phi_rad) noexcept {
  const Surface& n = joint.nozzle;
  const Eigen::Vector3d outward = std::cos(phi_rad) * frame.u + std::sin(phi_rad) * frame.v;
  const Eigen::Vector3d origin = n.point + n.radius_mm * outward;
  const Eigen::Vector3d direction = (n.axis + n.slope * outward).normalized();
  const Crossings found = crossings(joint.shell, origin, direction);
  for (int i = 0; i < found.count; ++i) {
    const Eigen::Vector3d p = origin + (i == 0 ? found.first : found.second) * direction;
    if (shell_normal(joint, p).dot(direction) > 0.0) {  // Here the nozzle comes out, not goes in.
      return p;
    }
  }
  return std::nullopt;
}

}  // namespace dseam::seam
