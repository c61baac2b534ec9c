// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

namespace dseam::geometry {

/// An infinite circular cylinder.
struct Cylinder {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();  ///< On the axis.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();     ///< Unit.
  double radius_mm = 0.0;

  /// Signed distance to the surface, positive outside.
  [[nodiscard]] double distance_mm(const Eigen::Vector3d& p) const noexcept;
  /// Outward unit normal; zero on the axis.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p) const noexcept;
};

/// Points by reference, one array a coordinate; `cloud::CloudView`'s spans fit in. The fits below
/// take normals the same way.
struct PointSpans {
  std::span<const float> x;
  std::span<const float> y;
  std::span<const float> z;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
  [[nodiscard]] Eigen::Vector3d operator[](std::size_t i) const noexcept {
    return {static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])};
  }
};

enum class FitState : std::uint8_t {
  kConverged,
  kTooFewPoints,
  kDegenerate,    ///< A parameter is not determined: flat, too short, or too narrow an arc.
  kNotConverged,  ///< The last step was still large after the last iteration.
};

/// How a robust fit of a surface goes on and ends.
struct SurfaceFitConfig {
  std::uint32_t max_iterations = 30;
  std::uint32_t min_points = 30;
  double start_gate_mm = 5.0;  ///< Residuals beyond it weigh nothing in the first iteration.
  double final_gate_mm = 0.1;  ///< The gate shrinks to 4.7 sigma, never under this.
  double min_radius_mm = 2.0;
  double max_radius_mm = 5000.0;
  /// How many points share one independent error, for the covariance; 1 for white noise.
  double points_per_independent_error = 1.0;
};

/// A cylinder through points, with what is known about its error.
///
/// Frame:   that of the points.
/// Shape:   `covariance` is of (shift along e1, along e2, tilt of the axis towards e1, towards e2,
///          radius) at `cylinder.point_mm`, which is the foot of the points' centroid.
struct CylinderFit {
  FitState state = FitState::kTooFewPoints;
  Cylinder cylinder;
  Eigen::Vector3d e1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d e2 = Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
  double rms_mm = 0.0;
  std::uint32_t num_inliers = 0;
  std::uint32_t iterations = 0;
};

/// A first guess from points with normals: the axis is the direction that no normal has, the radius
/// and the centre follow from p = centre + radius n. Empty when the normals do not span a plane.
///
/// Time:    O(points), no iteration.
[[nodiscard]] std::optional<Cylinder> guess_cylinder(const PointSpans& points,
                                                     const PointSpans& normals) noexcept;

/// Robust least squares of the distance to the surface (Tukey's weight under a shrinking gate).
///
/// Time:    O(points) an iteration, at most `max_iterations`.
/// Errors:  points that are not finite weigh nothing.
[[nodiscard]] CylinderFit fit_cylinder(const PointSpans& points, const Cylinder& start,
                                       const SurfaceFitConfig& config) noexcept;

/// Two unit vectors that make a right-handed base with `axis`.
void orthonormal_base(const Eigen::Vector3d& axis, Eigen::Vector3d& e1,
                      Eigen::Vector3d& e2) noexcept;

}  // namespace dseam::geometry
