// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/result.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::calibration {

/// One station of the calibration: where the robot was, and where the camera saw the target.
struct PosePair {
  geometry::RigidTransform T_base_flange;
  geometry::RigidTransform T_camera_target;
};

inline constexpr std::size_t kMaxPosePairs = 128;

/// What can be said of a calibration. Only kGood and kLargeResidual have a usable transform.
enum class HandEyeVerdict : std::uint8_t {
  kGood,
  kTooFewPoses,      ///< Fewer than three.
  kPosesTooSimilar,  ///< The robot hardly turned between the stations.
  kParallelAxes,     ///< It turned about one axis only: that direction stays unknown.
  kFlangeReversed,   ///< The flange poses fit when they are inverted.
  kTargetReversed,   ///< The target poses fit when they are inverted.
  kWrongScale,       ///< The target's translations are another unit, or its pitch is wrong.
  kLargeResidual,    ///< Consistent, but with residuals far over the stated noise.
};

[[nodiscard]] const char* name(HandEyeVerdict verdict) noexcept;

/// The noise of the poses, and where the error is to be stated.
struct HandEyeConfig {
  double flange_sigma_mm = 0.05;
  double flange_sigma_rad = 3.5e-4;  ///< 0.02 degree.
  double target_sigma_mm = 0.05;
  double target_sigma_rad = 3.5e-4;
  double min_spread_rad = 0.09;        ///< Of the turns about the second axis; 5 degrees.
  double max_residual_ratio = 10.0;    ///< Over the stated noise, before kLargeResidual.
  double working_distance_mm = 400.0;  ///< From the camera to the work, for `expected_tool_mm`.
};

/// Where the camera sits on the flange, and how well that is known.
///
/// Frame:   `T_flange_camera` takes camera coordinates to the flange; `covariance` is that of a
///          left perturbation of it (`geometry::perturbed`), in the flange frame.
struct HandEye {
  HandEyeVerdict verdict = HandEyeVerdict::kTooFewPoses;
  geometry::RigidTransform T_flange_camera;
  geometry::RigidTransform T_base_target;
  geometry::Matrix6 covariance = geometry::Matrix6::Zero();
  double rms_mm = 0.0;              ///< Of the target's position over the stations.
  double rms_rad = 0.0;             ///< Of its orientation.
  double residual_ratio = 0.0;      ///< Residuals over the stated noise; 1 is what noise gives.
  double expected_mm = 0.0;         ///< Expected error of the camera's position on the flange.
  double expected_rad = 0.0;        ///< Expected error of its orientation.
  double expected_tool_mm = 0.0;    ///< Expected error of a point at the working distance.
  double leave_one_out_mm = 0.0;    ///< The most that dropping one station moves such a point.
  std::uint32_t worst_station = 0;  ///< The station that does.
  double scale = 1.0;               ///< Factor that the target's translations lack.
  double scale_sigma = 0.0;
};

/// Finds T_flange_camera from stations that saw one fixed target.
///
/// Closed-form start (Park and Martin), then all stations together, each weighted by the noise of
/// its two poses carried through its lever; the covariance is scaled by the residuals.
///
/// Memory:  none but the stack, O(1).
/// Time:    O(n^2) of the stations, at most kMaxPosePairs.
/// Errors:  kInvalidArgument: more than kMaxPosePairs, a value that is not finite, sigmas that are
///          not positive. A bad geometry is a verdict.
/// Source:  Park and Martin, IEEE T-RO 10(5) 1994, for the start; weighted least squares with
///          implicit equations (Gauss-Helmert) for the rest.
[[nodiscard]] Result<HandEye> calibrate_hand_eye(std::span<const PosePair> stations,
                                                 const HandEyeConfig& config) noexcept;

}  // namespace dseam::calibration
