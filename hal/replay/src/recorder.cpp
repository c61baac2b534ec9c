// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/recorder.hpp"

namespace dseam::hal::replay {

Loaded<Recorder> Recorder::make(const depth::DepthModel& model, const std::filesystem::path& set) {
  const auto decoder = depth::FrameDecoder::make(model);
  if (!decoder.ok()) {
    return LoadFault{std::string("the camera's depth model cannot be recorded: ") +
                     name(decoder.error())};
  }
  auto writer = ScanSetWriter::create(set);
  if (!writer.ok()) {
    return LoadFault{writer.fault()};
  }
  return Recorder(decoder.value(), model.has_gray, std::move(writer.value()));
}

Recorder::Recorder(const depth::FrameDecoder& decoder, bool has_gray, ScanSetWriter writer)
    : decoder_(decoder), writer_(std::move(writer)) {
  view_.camera.intrinsics = decoder.intrinsics();
  view_.camera.mm_per_count = decoder.mm_per_count();
  view_.depth.resize(decoder.pixels());
  view_.gray.resize(has_gray ? decoder.pixels() : 0);
}

std::optional<LoadFault> Recorder::add(const DepthFrame& frame,
                                       const std::optional<StampedPose>& pose) {
  const auto report = decoder_.run({frame.depth, frame.gray}, {view_.depth, view_.gray});
  if (report.fault != depth::FrameDecoder::Fault::kNone) {
    return LoadFault{"frame " + std::to_string(frame.sequence) + " is shorter than its model says"};
  }
  ViewCamera& camera = view_.camera;
  camera.id = static_cast<std::uint32_t>(writer_.size());
  camera.stamp_ns = frame.captured_ns;
  camera.T_base_camera.reset();
  camera.T_base_flange.reset();
  if (pose) {
    (pose->of == PoseOf::kCamera ? camera.T_base_camera : camera.T_base_flange) =
        pose->T_base_reported;
  }
  return writer_.add(view_);
}

}  // namespace dseam::hal::replay
