// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "dseam/hal/sim/cell_config.hpp"
#include "dseam/hal/sim/solid.hpp"

namespace dseam::hal::sim {

/// The shell's outer surface, as a quadric over the part's xy plane, in closed form.
struct ShellSurface {
  ShellKind kind = ShellKind::kCylinder;
  double half_y = 0.0;    ///< Cylinder and sphere: horizontal half-axis.
  double half_z = 0.0;    ///< Vertical half-axis.
  double centre_z = 0.0;  ///< Height of the axis or centre; of the plane itself.

  /// The surface `offset_mm` further out.
  [[nodiscard]] ShellSurface grown(double offset_mm) const noexcept;
  /// The largest parameter of the line at which it meets the surface: the weld side.
  [[nodiscard]] std::optional<double> meet(const Ray& line) const noexcept;
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p) const noexcept;
};

/// The side of a nozzle or of its hole: straight lines, one at each angle round the axis.
struct Lateral {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  double a = 0.0;
  double b = 0.0;
  double taper = 0.0;

  [[nodiscard]] Ray ruling(double phi_rad) const noexcept;
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& p) const noexcept;
};

[[nodiscard]] ShellSurface shell_surface(const JointConfig& joint) noexcept;
[[nodiscard]] Lateral nozzle_side(const JointConfig& joint) noexcept;
[[nodiscard]] Lateral hole_side(const JointConfig& joint) noexcept;
[[nodiscard]] constexpr bool is_closed(JointKind kind) noexcept {
  return kind == JointKind::kSetIn || kind == JointKind::kSetOn;
}

/// Where the ruling at `phi_rad` meets the shell; none where the nozzle is beside it.
[[nodiscard]] std::optional<Eigen::Vector3d> joint_point(const Lateral& side,
                                                         const ShellSurface& shell,
                                                         double phi_rad) noexcept;

}  // namespace dseam::hal::sim
