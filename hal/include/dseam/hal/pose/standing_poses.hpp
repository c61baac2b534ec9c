// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/hal/pose/interpolated_poses.hpp"

namespace dseam::hal {

/// A robot that stands still at each view and is nowhere in between: the simulated one, and that
/// of a scan set, which has one pose a frame.
///
/// Context: stand() from the camera's consumer thread, pose_at() from any.
class StandingPoses final : public RobotState {
 public:
  StandingPoses() noexcept : poses_(slots_) {}

  /// The robot stood at `pose` for `half_dwell_ns` before and after its stamp.
  ///
  /// Errors:  kInvalidArgument: not after the stand before.
  Result<> stand(StampedPose pose, std::int64_t half_dwell_ns) noexcept {
    pose.stamp_ns -= half_dwell_ns;
    if (const Result<> from = poses_.push(pose); !from.ok()) {
      return from;
    }
    pose.stamp_ns += 2 * half_dwell_ns;
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

}  // namespace dseam::hal
