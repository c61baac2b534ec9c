// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace dseam::seam {
namespace {

// Where a point lies about the axis of a cylinder or cone.
struct Cylindrical {
  double along_mm;
  double radial_mm;
  Eigen::Vector3d outward;  // Zero on the axis.
};

Cylindrical about_axis(const Surface& s, const Eigen::Vector3d& p) noexcept {
  const Eigen::Vector3d q = p - s.point;
  const double along = q.dot(s.axis);
  const Eigen::Vector3d radial = q - along * s.axis;
  const double length = radial.norm();
  return {along, length, length > 0.0 ? Eigen::Vector3d(radial / length) : radial};
}

double cone_cosine(const Surface& s) noexcept { return 1.0 / std::sqrt(1.0 + s.slope * s.slope); }

}  // namespace

AcrossAxis across(const Eigen::Vector3d& axis) noexcept {
  int smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  const Eigen::Vector3d u = axis.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  return {u, axis.cross(u)};
}

double signed_distance(const Surface& s, const Eigen::Vector3d& p) noexcept {
  if (s.kind == SurfaceKind::kPlane) {
    return s.axis.dot(p - s.point);
  }
  if (s.kind == SurfaceKind::kSphere) {
    return (p - s.point).norm() - s.radius_mm;
  }
  const Cylindrical c = about_axis(s, p);
  return (c.radial_mm - s.radius_mm - s.slope * c.along_mm) * cone_cosine(s);
}

Eigen::Vector3d outward_normal(const Surface& s, const Eigen::Vector3d& p) noexcept {
  if (s.kind == SurfaceKind::kPlane) {
    return s.axis;
  }
  if (s.kind == SurfaceKind::kSphere) {
    const Eigen::Vector3d q = p - s.point;
    const double length = q.norm();
    return length > 0.0 ? Eigen::Vector3d(q / length) : q;
  }
  return (about_axis(s, p).outward - s.slope * s.axis) * cone_cosine(s);
}

int num_parameters(SurfaceKind kind) noexcept {
  constexpr int kCounts[] = {3, 4, 5, 6};
  return kCounts[static_cast<std::uint8_t>(kind)];
}

SurfaceVector distance_jacobian(const Surface& s, const Eigen::Vector3d& p) noexcept {
  SurfaceVector j = SurfaceVector::Zero();
  if (s.kind == SurfaceKind::kSphere) {
    j.head<3>() = -outward_normal(s, p);
    j[3] = -1.0;
    return j;
  }
  const AcrossAxis frame = across(s.axis);
  if (s.kind == SurfaceKind::kPlane) {
    const Eigen::Vector3d q = p - s.point;
    j.head<3>() << -1.0, q.dot(frame.u), q.dot(frame.v);
    return j;
  }
  const Cylindrical c = about_axis(s, p);
  const double scale = cone_cosine(s);
  const double lever = -(c.along_mm + s.slope * c.radial_mm) * scale;
  const double eu = c.outward.dot(frame.u);
  const double ev = c.outward.dot(frame.v);
  j << -scale * eu, -scale * ev, lever * eu, lever * ev, -scale, 0.0;
  if (s.kind == SurfaceKind::kCone) {
    const double over = c.radial_mm - s.radius_mm - s.slope * c.along_mm;
    j[5] = -scale * c.along_mm - over * s.slope * scale * scale * scale;
  }
  return j;
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
