// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

/// How points scatter about a closed curve, in order round it.
struct RimScatter {
  double rms = 0.0;
  double independent = 1.0;  ///< How many errors of their own they amount to.

  /// Of a mean over them. A rim that is cut or bent has few errors, and large ones.
  [[nodiscard]] double sigma_of_mean() const noexcept;
};
[[nodiscard]] RimScatter scatter_of(std::span<const double> residuals) noexcept;

/// The rim of a disc, refined from the gray profiles across it.
struct EllipseEdge {
  static constexpr std::size_t kProfiles = 48;

  bool converged = false;
  geometry::Ellipse ellipse;
  double rim_seen = 0.0;       ///< Share of the rim on which a step was found.
  double rms_px = 0.0;         ///< Of the edge points about the ellipse.
  double sigma_px = 0.0;       ///< Of its centre, from how they lie about it.
  double edge_width_px = 0.0;  ///< Median of (height of the step) / (its steepest slope).
  double contrast = 0.0;       ///< Mean height of the step, in gray values.
  double unevenness = 0.0;     ///< Standard deviation of the step's height, as a share of it.
  double flatness = 0.0;       ///< Difference of gray inside the disc, as a share of the step.
  std::array<Eigen::Vector2d, kProfiles> rim_px;  ///< The edges themselves, but for outliers:
  std::size_t num_rim = 0;                        ///< on a curved surface they are no ellipse.

  [[nodiscard]] std::span<const Eigen::Vector2d> rim() const noexcept {
    return std::span(rim_px).first(num_rim);
  }
};

/// Where the gray steps from one level to the other, along normals of the rim; then the ellipse
/// through these points, by Sampson's distance under Tukey's weight.
///
/// Time:    a bounded number of profiles, whatever the size of the disc.
[[nodiscard]] EllipseEdge refine_ellipse(const depth::DepthImage& frame,
                                         const geometry::Ellipse& start, bool dark_inside) noexcept;

}  // namespace dseam::markers
