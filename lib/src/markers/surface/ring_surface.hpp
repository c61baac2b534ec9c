// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"
#include "dseam/markers/ring_pixels.hpp"

namespace dseam::markers {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Depth as a quadratic of the pixel: z = q . (1, x, y, x^2, x y, y^2), x and y being pixels from
/// the centre over `scale`.
struct DepthQuadric {
  Vector6 q = Vector6::Zero();
  double u = 0.0;
  double v = 0.0;
  double scale = 1.0;
  double gate_mm = 0.0;  ///< What lies further off was not taken for the surface.

  [[nodiscard]] double z(double pu, double pv) const noexcept;
};

/// The surface as heights over its tangent plane, quadratic in the place on it: a pipe is one to a
/// micrometre from wherever it is seen, which depth over pixels is not.
///
/// Frame:   camera; height = q . (1, x, y, x^2, x y, y^2) along `normal`, all in mm.
struct TangentQuadric {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d e1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d e2 = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Towards the camera.
  Vector6 q = Vector6::Zero();

  [[nodiscard]] double height(double x, double y) const noexcept;
  /// Where the ray of the pixel meets it.
  [[nodiscard]] Eigen::Vector3d meet(const depth::Intrinsics& k, double u, double v) const noexcept;
};

/// The surface around a rim, from the depth of a ring beside it, for which `ring` is lent.
///
/// Time:    a bounded number of pixels, whatever the size of the disc.
struct RingSurface {
  DepthQuadric depth;
  TangentQuadric tangent;
};
[[nodiscard]] std::optional<RingSurface> fit_ring(const depth::DepthImage& frame,
                                                  const geometry::Ellipse& rim,
                                                  RingPixels& ring) noexcept;

/// Whether depth inside the rim lies off the surface around it.
[[nodiscard]] bool is_hole(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                           const DepthQuadric& surface, double max_depth_mm) noexcept;

}  // namespace dseam::markers
