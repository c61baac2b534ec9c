// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

/// Gray between pixels; the place must lie inside the image.
[[nodiscard]] double gray_between(const depth::DepthImage& frame, double u, double v) noexcept;
[[nodiscard]] bool inside_image(const depth::DepthImage& frame, double u, double v) noexcept;

/// How gray rises over the disc and over the ground around it, per pixel: light falls unevenly on
/// both, and what is taken for the level beside the rim would move the edge on all sides alike.
struct Shading {
  Eigen::Vector2d disc = Eigen::Vector2d::Zero();
  Eigen::Vector2d ground = Eigen::Vector2d::Zero();
};

/// Planes through gray inside and outside the rim; zero where pixels are few or not on a plane.
///
/// Time:    a bounded number of pixels.
[[nodiscard]] Shading shading_about(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                                    double reach_px) noexcept;

struct EdgePoint {
  Eigen::Vector2d p_px = Eigen::Vector2d::Zero();
  double width_px = 0.0;  ///< Height of the step over its steepest slope.
  double step = 0.0;
};

/// Where gray steps from the disc's level to the ground's on the line through `rim_px` along
/// `normal`; `sign` is 1 for a dark disc, -1 for a light one.
[[nodiscard]] std::optional<EdgePoint> find_edge(const depth::DepthImage& frame,
                                                 const Eigen::Vector2d& rim_px,
                                                 const Eigen::Vector2d& normal, double reach_px,
                                                 const Shading& shading, double sign) noexcept;

}  // namespace dseam::markers
