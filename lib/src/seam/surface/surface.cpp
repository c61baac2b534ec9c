// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface.hpp"

#include <Eigen/Geometry>

#include "dseam/seam/surface/surface_probe.hpp"

namespace dseam::seam {

AcrossAxis across(const Eigen::Vector3d& axis) noexcept {
  int smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  const Eigen::Vector3d u = axis.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  return {u, axis.cross(u)};
}

double signed_distance(const Surface& s, const Eigen::Vector3d& p) noexcept {
  return SurfaceProbe(s).touch(p).distance_mm;
}

Eigen::Vector3d outward_normal(const Surface& s, const Eigen::Vector3d& p) noexcept {
  const SurfaceProbe probe(s);
  return probe.normal(probe.touch(p));
}

int num_parameters(SurfaceKind kind) noexcept {
  constexpr int kCounts[] = {3, 4, 5, 6};
  return kCounts[static_cast<std::uint8_t>(kind)];
}

SurfaceVector distance_jacobian(const Surface& s, const Eigen::Vector3d& p) noexcept {
  const SurfaceProbe probe(s);
  return probe.jacobian(probe.touch(p), across(s.axis));
}

Surface stepped(const Surface& s, const SurfaceVector& step) noexcept {
  Surface out = s;
  if (s.kind == SurfaceKind::kSphere) {
    out.point += step.head<3>();
    out.radius_mm += step[3];
    return out;
  }
  const AcrossAxis frame = across(s.axis);
  if (s.kind == SurfaceKind::kPlane) {
    out.point += step[0] * s.axis;
    out.axis = (s.axis + step[1] * frame.u + step[2] * frame.v).normalized();
    return out;
  }
  out.point += step[0] * frame.u + step[1] * frame.v;
  out.axis = (s.axis + step[2] * frame.u + step[3] * frame.v).normalized();
  out.radius_mm += step[4];
  out.slope += s.kind == SurfaceKind::kCone ? step[5] : 0.0;
  return out;
}

}  // namespace dseam::seam
