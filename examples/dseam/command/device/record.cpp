// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <iostream>

#include "command/commands.hpp"
#include "dseam/hal/replay/recorder.hpp"
#include "scan/open_scan.hpp"
#include "terminal/interrupt.hpp"
#include "terminal/progress.hpp"

namespace dseam::program {
namespace {

void fail_if(const std::optional<hal::replay::LoadFault>& fault) {
  if (fault) {
    throw Failure(ExitCode::kUsage, fault->text);
  }
}

void record_view(ScanSource& source, hal::replay::Recorder& recorder) {
  source.await_view();
  const auto lease = source.camera().next(std::chrono::seconds(5));
  if (!lease.ok()) {
    throw Failure(ExitCode::kDevice, source.description() + ": no frame: " + name(lease.error()));
  }
  const hal::DepthFrame& frame = lease.value().frame();
  std::optional<hal::StampedPose> pose;
  if (source.robot_state() != nullptr) {
    source.await_report(frame.captured_ns);
    const auto reported = source.robot_state()->pose_at(frame.captured_ns);
    pose = reported.ok() ? std::optional(reported.value()) : std::nullopt;
  }
  fail_if(recorder.add(frame, pose));
}

}  // namespace

ExitCode run_record(const RecordOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  const auto source = open_scan(options.camera, settings);
  auto recorder = hal::replay::Recorder::make(source->camera().model(), options.out);
  if (!recorder.ok()) {
    throw Failure(ExitCode::kUsage, recorder.fault());
  }
  if (!source->camera().start(hal::FrameMode::kEvery).ok()) {
    throw Failure(ExitCode::kDevice, source->description() + ": cannot be started");
  }
  Progress progress;
  for (std::size_t i = 0; i < source->num_views() && !interrupted; ++i) {
    progress.show("recording", i + 1, source->num_views());
    record_view(*source, recorder.value());
  }
  source->camera().stop();
  if (interrupted) {
    throw Failure(ExitCode::kDevice, "interrupted: nothing was recorded");
  }
  fail_if(recorder.value().commit());
  std::cout << "recorded " << recorder.value().num_frames() << " views: " << options.out.string()
            << '\n';
  return ExitCode::kDone;
}

}  // namespace dseam::program
