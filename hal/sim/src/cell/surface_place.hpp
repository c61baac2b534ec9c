// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/base/random.hpp"
#include "shape/joint_geometry.hpp"

namespace dseam::hal::sim {

/// A place on the shell's outside with a frame: x and y along the surface, z outwards.
struct Place {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

/// Draws places on the shell near the joint.
class PlaceFinder {
 public:
  explicit PlaceFinder(const JointConfig& joint);

  /// `distance_mm` outside the joint, in the direction `phi_rad` about the nozzle; none where the
  /// shell ends or turns away from the cameras.
  [[nodiscard]] std::optional<Place> outside_joint(double phi_rad, double distance_mm) const;
  /// A point on the nozzle's side, `height_mm` above the joint; none for open joints.
  [[nodiscard]] std::optional<Place> on_nozzle(double phi_rad, double height_mm) const;
  [[nodiscard]] std::optional<Place> on_joint(double phi_rad) const;

 private:
  JointConfig joint_;
  ShellSurface shell_;
  Lateral side_;
  Lateral hole_;
};

}  // namespace dseam::hal::sim
