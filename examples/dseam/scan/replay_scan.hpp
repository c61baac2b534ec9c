// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/replay/replay_camera.hpp"
#include "scan/scan.hpp"

namespace dseam::program {

/// A recorded scan set, as fast as it can be read.
class ReplayScan final : public ScanSource {
 public:
  /// Errors:  throws Failure(kInput) with the file and its fault.
  explicit ReplayScan(const std::filesystem::path& set);

  hal::DepthCamera& camera() override { return *camera_; }
  hal::RobotState* robot_state() override { return &camera_->robot_state(); }
  [[nodiscard]] std::size_t num_views() const override { return camera_->num_views(); }
  [[nodiscard]] std::string description() const override { return set_.string(); }

 private:
  std::filesystem::path set_;
  hal::fake::ManualClock clock_;
  std::unique_ptr<hal::replay::ReplayCamera> camera_;
};

}  // namespace dseam::program
