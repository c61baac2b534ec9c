// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "dseam/depth/depth_image.hpp"
#include "dseam/markers/ring_pixels.hpp"
#include "markers/rim/ellipse_edge.hpp"

namespace dseam::markers {

enum class DiscState : std::uint8_t { kDisc, kNoSurface, kNotCircular, kHole };

/// A rim in the image laid onto the surface around it.
///
/// Frame:   camera.
struct SurfaceDisc {
  DiscState state = DiscState::kNoSurface;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Towards the camera.
  double radius_mm = 0.0;
  double out_of_round = 0.0;  ///< rms of the rim's points about the circle, over its radius.
  double sigma_mm = 0.0;      ///< Of the centre along the surface, from how they lie about it.
};

/// Fits a quadratic surface to the ring around the rim, lays the rim's edges on it and takes the
/// circle through them: that corrects perspective and the surface's curvature. The edges and not
/// the ellipse, since the rim of a disc on a pipe is none, by a hundredth of a pixel on a small
/// one.
///
/// Memory:  `ring`, which is lent.
/// Time:    a bounded number of pixels, whatever the size of the disc.
[[nodiscard]] SurfaceDisc lay_on_surface(const depth::DepthImage& frame, const EllipseEdge& edge,
                                         double max_hole_depth_mm, RingPixels& ring) noexcept;

}  // namespace dseam::markers
