// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

enum class Polarity : std::uint8_t { kDarkOnLight, kLightOnDark };

/// One marker disc as seen in one view.
///
/// Frame:   camera.
struct Marker {
  /// The disc's centre in the image: not the ellipse's, which perspective moves, unless there is
  /// no depth to correct it by.
  double u = 0.0;
  double v = 0.0;
  bool has_depth = false;  ///< False for gray alone: then p_camera, covariance, radius_mm are 0.
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();
  double radius_mm = 0.0;
  double sigma_px = 0.0;  ///< Of u and of v.
  Polarity polarity = Polarity::kDarkOnLight;
  geometry::Ellipse ellipse;  ///< The rim; what lies within 1.3 of it is not the part's surface.
};

}  // namespace dseam::markers
