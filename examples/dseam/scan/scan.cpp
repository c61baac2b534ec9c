// SPDX-License-Identifier: Apache-2.0
#include "scan/scan.hpp"

#include <chrono>

#include "dseam/depth/frame_decoder.hpp"
#include "failure.hpp"

namespace dseam::program {
namespace {

constexpr std::chrono::seconds kFrameLimit(5);

/// Decodes `frame` into the view's own memory.
void decode(const depth::FrameDecoder& decoder, const hal::DepthFrame& frame, ScannedView& view) {
  view.depth.resize(decoder.pixels());
  view.gray.resize(frame.gray.empty() ? 0 : decoder.pixels());
  const depth::ImageBuffers buffers{view.depth, view.gray};
  const auto report = decoder.run({frame.depth, frame.gray}, buffers);
  if (report.fault != depth::FrameDecoder::Fault::kNone) {
    throw Failure(ExitCode::kDevice, "camera: a frame is shorter than the format promises");
  }
  view.image = decoder.image(buffers);
  view.captured_ns = frame.captured_ns;
}

void add_pose(hal::RobotState& robot,
              const std::optional<geometry::RigidTransform>& T_flange_camera, ScannedView& view) {
  const auto pose = robot.pose_at(view.captured_ns);
  if (!pose.ok()) {
    return;  // Nothing was reported near that time: the view is spliced without.
  }
  if (pose.value().of == hal::PoseOf::kCamera) {
    view.T_base_camera = pose.value().T_base_reported;
    return;
  }
  view.T_base_flange = pose.value().T_base_reported;
  if (!T_flange_camera) {
    throw Failure(ExitCode::kUsage,
                  "the robot reports its flange: --hand-eye FILE is needed (dseam calibrate)");
  }
  view.T_base_camera = *view.T_base_flange * *T_flange_camera;
}

}  // namespace

std::vector<ScannedView> take_views(ScanSource& source,
                                    const std::optional<geometry::RigidTransform>& T_flange_camera,
                                    const std::atomic<bool>& interrupted, Progress& progress) {
  hal::DepthCamera& camera = source.camera();
  const auto decoder = depth::FrameDecoder::make(camera.model());
  if (!decoder.ok() || !camera.start(hal::FrameMode::kEvery).ok()) {
    throw Failure(ExitCode::kDevice, source.description() + ": cannot be started");
  }
  std::vector<ScannedView> views(source.num_views());
  for (std::size_t i = 0; i < views.size(); ++i) {
    progress.show("scanning", i, views.size());
    source.await_view();
    const auto lease = camera.next(kFrameLimit);
    if (!lease.ok() || interrupted) {
      throw Failure(ExitCode::kDevice, source.description() + ": view " + std::to_string(i) + ": " +
                                           (interrupted ? "interrupted" : name(lease.error())));
    }
    decode(decoder.value(), lease.value().frame(), views[i]);
    if (source.robot_state() != nullptr) {
      source.await_report(views[i].captured_ns);
      add_pose(*source.robot_state(), T_flange_camera, views[i]);
    }
  }
  progress.show("scanning", views.size(), views.size());
  camera.stop();
  return views;
}

}  // namespace dseam::program
