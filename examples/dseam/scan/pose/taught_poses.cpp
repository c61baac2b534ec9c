// SPDX-License-Identifier: Apache-2.0
#include "scan/pose/taught_poses.hpp"

#include <fstream>
#include <sstream>

#include "dseam/hal/replay/scan_set.hpp"
#include "failure.hpp"

namespace dseam::program {

TaughtPoses::TaughtPoses(const std::filesystem::path& file) {
  if (file.empty()) {
    return;
  }
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) {
    throw Failure(ExitCode::kInput, file.string() + ": cannot be read");
  }
  const auto views = hal::replay::parse_scene_camera(text.str(), file);
  if (!views.ok()) {
    throw Failure(ExitCode::kInput, views.fault());
  }
  for (const hal::replay::ViewCamera& view : views.value()) {
    const auto& pose = view.T_base_camera ? view.T_base_camera : view.T_base_flange;
    if (!pose) {
      throw Failure(ExitCode::kInput, file.string() + ": a view without a pose");
    }
    const hal::PoseOf of = view.T_base_camera ? hal::PoseOf::kCamera : hal::PoseOf::kFlange;
    poses_.push_back({0, of, *pose});
  }
}

Result<hal::StampedPose> TaughtPoses::do_pose_at(std::int64_t stamp_ns) noexcept {
  if (reached_ == 0 || reached_ > poses_.size()) {
    return Errc::kNotFound;
  }
  hal::StampedPose pose = poses_[reached_ - 1];
  pose.stamp_ns = stamp_ns;
  return pose;
}

}  // namespace dseam::program
