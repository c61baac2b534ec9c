// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/hal/interpolated_poses.hpp"

namespace dseam::hal::sim {

/// What the simulated robot reports: it stands still at each view and is nowhere in between.
///
/// Context: stand() from the scanner's consumer thread, pose_at() from any.
class SimRobotState final : public RobotState {
 public:
  SimRobotState() noexcept : poses_(slots_) {}

  /// The robot stood at `pose` from its stamp on until `until_ns`.
  ///
  /// Errors:  kInvalidArgument: not after the stand before.
  Result<> stand(StampedPose pose, std::int64_t until_ns) noexcept {
    if (const Result<> from = poses_.push(pose); !from.ok()) {
      return from;
    }
    pose.stamp_ns = until_ns;
    return poses_.push(pose);
  }

 private:
  static constexpr std::size_t kMaxReports = 128;

  Result<StampedPose> do_pose_at(std::int64_t stamp_ns) noexcept override {
    return static_cast<RobotState&>(poses_).pose_at(stamp_ns);
  }

  std::array<InterpolatedPoses::Slot, kMaxReports> slots_;
  InterpolatedPoses poses_;
};

}  // namespace dseam::hal::sim
