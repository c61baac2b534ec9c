// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "dseam/seam/surface/surface.hpp"

namespace dseam::seam {

/// Asks one surface about many points: what is the same for all of them is computed once, and what
/// distance, normal and jacobian of a point have in common once for the three.
///
/// Frame:   the surface's.
/// Units:   mm.
class SurfaceProbe {
 public:
  /// Where a point lies beside the surface.
  struct Contact {
    double distance_mm;      ///< As signed_distance() says.
    double along_mm;         ///< Along a cylinder's or cone's axis.
    double radial_mm;        ///< Length of `radial`; of a plane 0.
    Eigen::Vector3d radial;  ///< From the axis or the sphere's centre; from a plane's point.
  };

  explicit SurfaceProbe(const Surface& surface = {}) noexcept
      : surface_(surface), cosine_(1.0 / std::sqrt(1.0 + surface.slope * surface.slope)) {}

  [[nodiscard]] const Surface& surface() const noexcept { return surface_; }
  [[gnu::always_inline, nodiscard]] Contact touch(const Eigen::Vector3d& p) const noexcept {
    const Surface& s = surface_;
    const Eigen::Vector3d q = p - s.point;
    if (s.kind == SurfaceKind::kPlane) {
      return {s.axis.dot(q), 0.0, 0.0, q};
    }
    if (s.kind == SurfaceKind::kSphere) {
      const double length = q.norm();
      return {length - s.radius_mm, 0.0, length, q};
    }
    const double along = q.dot(s.axis);
    const Eigen::Vector3d radial = q - along * s.axis;
    const double length = radial.norm();
    return {(length - s.radius_mm - s.slope * along) * cosine_, along, length, radial};
  }
  /// As outward_normal() says.
  [[gnu::always_inline, nodiscard]] Eigen::Vector3d normal(const Contact& contact) const noexcept {
    if (surface_.kind == SurfaceKind::kPlane) {
      return surface_.axis;
    }
    const Eigen::Vector3d outward = outward_of(contact);
    return surface_.kind == SurfaceKind::kSphere
               ? outward
               : Eigen::Vector3d((outward - surface_.slope * surface_.axis) * cosine_);
  }
  /// As distance_jacobian() says; `frame` is across() of the surface's axis.
  [[gnu::always_inline, nodiscard]] SurfaceVector jacobian(const Contact& contact,
                                                           const AcrossAxis& frame) const noexcept {
    const Surface& s = surface_;
    SurfaceVector j = SurfaceVector::Zero();
    if (s.kind == SurfaceKind::kPlane) {
      j.head<3>() << -1.0, contact.radial.dot(frame.u), contact.radial.dot(frame.v);
      return j;
    }
    const Eigen::Vector3d outward = outward_of(contact);
    if (s.kind == SurfaceKind::kSphere) {
      j.head<3>() = -outward;
      j[3] = -1.0;
      return j;
    }
    const double lever = -(contact.along_mm + s.slope * contact.radial_mm) * cosine_;
    const double eu = outward.dot(frame.u);
    const double ev = outward.dot(frame.v);
    j << -cosine_ * eu, -cosine_ * ev, lever * eu, lever * ev, -cosine_, 0.0;
    if (s.kind == SurfaceKind::kCone) {
      const double over = contact.radial_mm - s.radius_mm - s.slope * contact.along_mm;
      j[5] = -cosine_ * contact.along_mm - over * s.slope * cosine_ * cosine_ * cosine_;
    }
    return j;
  }

 private:
  [[nodiscard]] static Eigen::Vector3d outward_of(const Contact& contact) noexcept {
    return contact.radial_mm > 0.0 ? Eigen::Vector3d(contact.radial / contact.radial_mm)
                                   : contact.radial;
  }

  Surface surface_;
  double cosine_;  ///< Of a cone's half angle.
};

}  // namespace dseam::seam
