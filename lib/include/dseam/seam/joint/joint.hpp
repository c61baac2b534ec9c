// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/seam/surface/surface.hpp"

namespace dseam::seam {

/// The two surfaces that meet in a ring, set up so that both normals point to the air: the shell's
/// to the side from which the nozzle sticks out, the nozzle's away from its axis, and the nozzle's
/// axis out of the shell.
struct Joint {
  Surface shell;
  Surface nozzle;
  double shell_sign = 1.0;  ///< -1: the air is on the inside of the shell's signed distance.
};

[[nodiscard]] double shell_distance(const Joint& joint, const Eigen::Vector3d& p) noexcept;
[[nodiscard]] Eigen::Vector3d shell_normal(const Joint& joint, const Eigen::Vector3d& p) noexcept;

/// Two unit vectors across the nozzle's axis: angle 0 is base x laid into the ring, and angles
/// grow counter-clockwise as seen from the nozzle's free end.
struct NozzleFrame {
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
};
[[nodiscard]] NozzleFrame frame_of(const Surface& nozzle) noexcept;
[[nodiscard]] double angle_about(const Surface& nozzle, const NozzleFrame& frame,
                                 const Eigen::Vector3d& p) noexcept;

/// Where the nozzle's generator at an angle leaves the shell; nothing where it passes it by.
[[nodiscard]] std::optional<Eigen::Vector3d> root_at(const Joint& joint, const NozzleFrame& frame,
                                                     double phi_rad) noexcept;

}  // namespace dseam::seam
