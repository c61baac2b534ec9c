// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>

#include "command/commands.hpp"
#include "files/hand_eye_file.hpp"
#include "files/products.hpp"
#include "job/motion_job.hpp"
#include "job/scan_job.hpp"
#include "job/stopwatch.hpp"
#include "robot/drive_robot.hpp"
#include "scan/open_scan.hpp"
#include "scan/sim_scan.hpp"
#include "terminal/interrupt.hpp"

namespace dseam::program {
namespace {

std::optional<geometry::RigidTransform> hand_eye_of(const WeldOptions& options,
                                                    Settings& settings) {
  if (options.hand_eye.empty()) {
    return std::nullopt;
  }
  const HandEyeFile file = read_hand_eye(options.hand_eye);
  if (settings.seam.hand_eye_sigma_mm <= 0.0) {
    settings.seam.hand_eye_sigma_mm = file.expected_tool_mm;
  }
  return file.T_flange_camera;
}

void write_truth_of(const ScanSource& source, const std::filesystem::path& folder) {
  const auto* simulated = dynamic_cast<const SimScan*>(&source);
  if (simulated == nullptr) {
    throw Failure(ExitCode::kUsage, "--truth: only the simulated cell knows the truth");
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !hal::sim::write_truth(simulated->cell(), folder).ok()) {
    throw Failure(ExitCode::kUsage, folder.string() + ": cannot be written");
  }
}

/// A calibration that no view could use must not go unnoticed.
void check_hand_eye(const WeldOptions& options, const std::vector<ScannedView>& views) {
  const bool used = std::any_of(views.begin(), views.end(), [](const ScannedView& view) {
    return view.T_base_flange.has_value();
  });
  if (!options.hand_eye.empty() && !used) {
    throw Failure(ExitCode::kInput, options.hand_eye.string() +
                                        ": of no use, since no view has a pose of the flange");
  }
}

/// Plans and drives; returns what the program should end with.
ExitCode weld_seam(const WeldOptions& options, const Settings& settings, OutputFolder& folder,
                   const std::atomic<bool>& interrupted, Progress& progress, MotionJob& motion,
                   JobReport& job) {
  Stopwatch watch;
  const trajectory::SetPointView planned = motion.plan();
  job.stages.push_back(
      {"motion", watch.lap_ms(), {{"set points", static_cast<double>(planned.size())}}});
  job.path = planned;
  if (planned.empty()) {
    job.weld = false;
    job.reason = motion.why();
    return ExitCode::kRefused;
  }
  if (options.robot == "none") {
    return ExitCode::kDone;
  }
  if (!job.has_base) {
    job.weld = false;
    job.reason =
        "no pose of the robot is known, so the path is not in its base: no robot is driven";
    return ExitCode::kRefused;
  }
  const DriveReport drive = drive_robot(options.robot, options.waive_operator, settings.session,
                                        motion, folder.reserve("can.log"), interrupted, progress);
  job.stages.push_back({"robot", watch.lap_ms(), {}});
  job.path = motion.points();
  job.robot = drive.facts;
  if (!drive.finished) {
    job.fault = (interrupted ? "interrupted: " : "") + drive.fault;
    return ExitCode::kDevice;
  }
  return ExitCode::kDone;
}

/// The configuration and what the command line adds to it; refused where no weld can follow it.
Settings settings_of(const WeldOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  if (settings.shape == SeamShape::kOpen) {
    throw Failure(ExitCode::kUsage, "open seams are found in a merged cloud: use dseam extract");
  }
  if (settings.method == Method::kPaper) {
    throw Failure(ExitCode::kUsage,
                  "job.method = \"paper\" works on a merged cloud: dseam extract has it");
  }
  if (options.robot.starts_with("can:") && settings.camera.pose_interface.empty() &&
      !options.hand_eye.empty()) {
    settings.camera.pose_interface =
        options.robot.substr(4);  // Who moves the camera can say where.
  }
  return settings;
}

}  // namespace

ExitCode run_weld(const WeldOptions& options, const Invocation& invocation) {
  Settings settings = settings_of(options, invocation);
  check_robot(options.robot, options.waive_operator);
  const auto T_flange_camera = hand_eye_of(options, settings);
  OutputFolder folder(options.out);
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  Progress progress;
  Stopwatch watch;
  auto source = open_scan(options.camera, settings);
  if (!options.truth.empty()) {
    write_truth_of(*source, options.truth);
  }
  const std::vector<ScannedView> views =
      take_views(*source, T_flange_camera, interrupted, progress);
  check_hand_eye(options, views);

  JobReport job;
  job.command = "weld";
  job.input = source->description() + ", robot " + options.robot;
  source.reset();  // From here on nobody else talks to the robot.
  job.stages.push_back({"scan", watch.lap_ms(), {{"views", static_cast<double>(views.size())}}});
  progress.say("finding the seam");
  ScanJob scan(settings, views);
  ExitCode code = scan.run(views, job);
  MotionJob motion(settings, job.seam_base);
  if (code == ExitCode::kDone) {
    code = weld_seam(options, settings, folder, interrupted, progress, motion, job);
  }
  if (interrupted && job.robot.empty()) {
    throw Failure(ExitCode::kDevice, "interrupted before the weld: nothing was written");
  }
  write_products(job, folder);
  print_summary(job, folder);
  return code;
}

}  // namespace dseam::program
