// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/result.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::hal {

/// What a reported pose is the pose of. A flange needs the hand-eye calibration, a camera does not.
enum class PoseOf : std::uint8_t { kFlange, kCamera };

/// Where the robot says it was.
///
/// Frame:   `T_base_reported` takes coordinates of the flange, or of the camera, to the base.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  PoseOf of = PoseOf::kFlange;
  geometry::RigidTransform T_base_reported;
};

/// The robot's reported pose over time. Sources: the weld link's pose messages, a file, simulated.
///
/// Context: pose_at() from the vision thread; never blocks.
class RobotState {
 public:
  RobotState() = default;
  RobotState(const RobotState&) = delete;
  RobotState& operator=(const RobotState&) = delete;

  /// The pose at `stamp_ns`, interpolated between the two reports around it.
  ///
  /// Errors:  kNotFound: nothing was reported near enough to that time; it is never extrapolated.
  [[nodiscard]] Result<StampedPose> pose_at(std::int64_t stamp_ns) noexcept {
    return do_pose_at(stamp_ns);
  }

 protected:
  ~RobotState() = default;  // Owners hold the concrete type: no delete through a base.

 private:
  virtual Result<StampedPose> do_pose_at(std::int64_t stamp_ns) noexcept = 0;
};

}  // namespace dseam::hal
