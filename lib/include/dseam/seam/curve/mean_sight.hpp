// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "dseam/seam/seam_curve.hpp"

namespace dseam::seam {

/// How a seam's point is looked at. An error of depth moves it along the lines of sight.
///
/// The mean of the unit vectors to the viewpoints that face both surfaces there, each with the
/// share of pixels that it gives the nozzle's wall: the cosine at which it sees it.
struct MeanSight {
  double lateral = 1.0;  ///< Along the shell, across the seam, away from the nozzle.
  double normal = 1.0;   ///< Along the shell's normal.

  /// How far a pixel's ray runs along the shell while it rises by one above it.
  [[nodiscard]] double slant() const noexcept { return lateral / normal; }
};

/// Where no viewpoint is known, or none sees the point, an error may be in any direction: 1, 1.
///
/// Frame:   that of the point, as the viewpoints.
[[nodiscard]] MeanSight mean_sight(std::span<const Eigen::Vector3d> viewpoints,
                                   const SeamPoint& point) noexcept;

}  // namespace dseam::seam
