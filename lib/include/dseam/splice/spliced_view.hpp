// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::splice {

/// What the robot says of a view before splicing: a pose with an error of a millimetre or so.
struct ReportedPose {
  bool known = false;
  geometry::RigidTransform T_base_camera;
};

/// Why a view has no adjusted pose, or kUsed.
enum class ViewState : std::uint8_t {
  kUsed,
  kNoOverlap,     ///< Nothing ties it to the other views.
  kContradicts,   ///< It disagrees with the rest beyond its covariance; left out.
  kUnobservable,  ///< Its geometry leaves a direction free and nothing else pins it.
  kEmpty,         ///< No valid depth.
};

/// A view after the adjustment of all views together.
///
/// Frame:   base. `covariance` is that of a left perturbation (`geometry::perturbed`) about the
///          base origin: (mm, rad).
struct SplicedView {
  ViewState state = ViewState::kEmpty;
  geometry::RigidTransform T_base_camera;
  geometry::Matrix6 covariance = geometry::Matrix6::Zero();
  double marker_rms_mm = 0.0;
  double surface_rms_mm = 0.0;
  std::uint32_t num_markers = 0;
};

}  // namespace dseam::splice
