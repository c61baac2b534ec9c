// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "job/motion_job.hpp"
#include "robot/weld_run.hpp"
#include "terminal/progress.hpp"

namespace dseam::program {

/// What came of driving a robot.
struct DriveReport {
  bool finished = false;
  std::string fault;  ///< Why not, as one sentence.
  std::vector<std::pair<std::string, std::string>> facts;
};

/// Throws Failure(kUsage) for another word than `sim`, `none` or `can:IFACE`, and for a real robot
/// (on a bus that is not virtual) that nobody at a terminal could enable, unless that is waived.
/// Throws Failure(kDevice) where there is no such interface.
void check_robot(const std::string& robot, bool waive_operator);

/// Drives the robot named along the planned path; every frame on the bus goes to `can_log`. A real
/// robot waits for the operator's key, unless that is waived.
///
/// Errors:  throws Failure(kDevice) where the bus cannot be opened.
[[nodiscard]] DriveReport drive_robot(const std::string& robot, bool waive_operator,
                                      const WeldRun::Config& config, MotionJob& motion,
                                      const std::filesystem::path& can_log,
                                      const std::atomic<bool>& interrupted, Progress& progress);

}  // namespace dseam::program
