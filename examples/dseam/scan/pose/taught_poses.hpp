// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "dseam/hal/robot_state.hpp"

namespace dseam::program {

/// Where the camera stands at each view of a scan that a robot's own program drives: the taught
/// poses, in the order of the views.
class TaughtPoses final : public hal::RobotState {
 public:
  /// `file` is a scene_camera.json; of each view only the pose is read. Empty: nothing is known.
  ///
  /// Errors:  throws Failure(kInput) with the file and its fault.
  explicit TaughtPoses(const std::filesystem::path& file);

  /// The robot has reached its next pose.
  void advance() { ++reached_; }
  [[nodiscard]] bool known() const { return !poses_.empty(); }

 private:
  Result<hal::StampedPose> do_pose_at(std::int64_t stamp_ns) noexcept override;

  std::vector<hal::StampedPose> poses_;
  std::size_t reached_ = 0;
};

}  // namespace dseam::program
