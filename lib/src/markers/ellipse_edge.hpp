// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

/// The rim of a disc, refined from the gray profiles across it.
struct EllipseEdge {
  bool converged = false;
  geometry::Ellipse ellipse;
  double rim_seen = 0.0;       ///< Share of the rim on which a step was found.
  double rms_px = 0.0;         ///< Of the edge points about the ellipse.
  double edge_width_px = 0.0;  ///< Median of (height of the step) / (its steepest slope).
  double contrast = 0.0;       ///< Mean height of the step, in gray values.
  double unevenness = 0.0;     ///< Standard deviation of the step's height, as a share of it.
  double flatness = 0.0;       ///< Difference of gray inside the disc, as a share of the step.
};

/// Where the gray steps from one level to the other, along normals of the rim; then the ellipse
/// through these points, by Sampson's distance under Tukey's weight.
///
/// Time:    a bounded number of profiles, whatever the size of the disc.
[[nodiscard]] EllipseEdge refine_ellipse(const depth::DepthImage& frame,
                                         const geometry::Ellipse& start, bool dark_inside) noexcept;

}  // namespace dseam::markers
