// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "dseam/hal/sim/cell_config.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::hal::sim {

/// One point of a true seam.
struct TruthPoint {
  double s_mm = 0.0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d n_shell = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d n_nozzle = Eigen::Vector3d::UnitX();
  double dihedral_rad = 0.0;
};

/// A true reference curve, counterclockwise about the nozzle's axis; open joints run along +x.
///
/// Shape:   a point every 0.5 mm (a little less, so that closed curves come out even); a closed
///          curve does not repeat its first point.
struct TruthCurve {
  std::vector<TruthPoint> points;
  double length_mm = 0.0;
  bool closed = true;
};

/// The reference curve in closed form, computed apart from the stages of lib/.
///
/// Frame:   part.
/// Errors:  none where the joint does not have that curve.
[[nodiscard]] std::optional<TruthCurve> truth_curve(const JointConfig& joint,
                                                    seam::ReferenceCurve reference);

/// The same curve in another frame.
[[nodiscard]] TruthCurve transformed(const geometry::RigidTransform& T_to_from, TruthCurve curve);

}  // namespace dseam::hal::sim
