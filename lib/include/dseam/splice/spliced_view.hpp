// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

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
  kDuplicate,     ///< The same frame as an earlier view.
  kAmbiguous,     ///< It fits in several places.
};
inline constexpr std::size_t kNumViewStates = 7;

/// A view after the adjustment of all views together.
///
/// Frame:   base. `covariance` is that of a left perturbation (`geometry::perturbed`) about the
///          base origin: (mm, rad). It is relative to the mean of the used views; the error that
///          all have in common is `NetworkReport::base_covariance`.
struct SplicedView {
  ViewState state = ViewState::kEmpty;
  geometry::RigidTransform T_base_camera;
  geometry::Matrix6 covariance = geometry::Matrix6::Zero();
  double marker_rms_mm = 0.0;
  double surface_rms_mm = 0.0;
  std::uint32_t num_markers = 0;
  bool reported_pose_rejected = false;  ///< The robot's pose contradicts all else.
};

/// Standard deviation of the place that a left perturbation with this covariance gives a point.
[[nodiscard]] double predicted_error_mm(const geometry::Matrix6& covariance,
                                        const Eigen::Vector3d& p_base) noexcept;
/// The splice error to be expected at a point: the spread of the used views' images of it.
[[nodiscard]] double predicted_spread_mm(std::span<const SplicedView> views,
                                         const Eigen::Vector3d& p_base) noexcept;

}  // namespace dseam::splice
