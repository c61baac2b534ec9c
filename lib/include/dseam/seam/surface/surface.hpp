// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace dseam::seam {

enum class SurfaceKind : std::uint8_t { kPlane, kSphere, kCylinder, kCone };

/// The most parameters a surface has: a cone's two shifts, two tilts, radius and slope.
inline constexpr int kMaxSurfaceParameters = 6;
using SurfaceVector = Eigen::Matrix<double, kMaxSurfaceParameters, 1>;
using SurfaceMatrix = Eigen::Matrix<double, kMaxSurfaceParameters, kMaxSurfaceParameters>;

/// A plane, sphere, cylinder or cone.
///
/// Frame:   that of the points it was fitted to.
/// Units:   mm.
/// Shape:   plane: `axis` is the normal. Sphere: `axis` is unused. Cone: `radius_mm` is that at
///          `point`, and grows by `slope` for each mm along `axis`.
struct Surface {
  SurfaceKind kind = SurfaceKind::kPlane;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double radius_mm = 0.0;
  double slope = 0.0;
};

/// Signed distance from the surface, positive outside (on the normal's side of a plane).
[[nodiscard]] double signed_distance(const Surface& surface, const Eigen::Vector3d& p) noexcept;
/// Unit gradient of the signed distance; zero on a cylinder's axis or a sphere's centre.
[[nodiscard]] Eigen::Vector3d outward_normal(const Surface& surface,
                                             const Eigen::Vector3d& p) noexcept;

/// Unknowns of a fit: shifts along two directions across the axis, tilts, radius, slope.
[[nodiscard]] int num_parameters(SurfaceKind kind) noexcept;
/// Change of the signed distance of `p` with each parameter; those beyond num_parameters() are 0.
[[nodiscard]] SurfaceVector distance_jacobian(const Surface& surface,
                                              const Eigen::Vector3d& p) noexcept;
/// The surface after a step of its parameters.
[[nodiscard]] Surface stepped(const Surface& surface, const SurfaceVector& step) noexcept;

/// Two unit vectors that complete `axis` to a right-handed frame; the same ones for the same axis.
struct AcrossAxis {
  Eigen::Vector3d u;
  Eigen::Vector3d v;
};
[[nodiscard]] AcrossAxis across(const Eigen::Vector3d& axis) noexcept;

}  // namespace dseam::seam
