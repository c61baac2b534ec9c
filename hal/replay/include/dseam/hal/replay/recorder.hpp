// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dseam/depth/frame_decoder.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/replay/scan_set.hpp"
#include "dseam/hal/robot_state.hpp"

namespace dseam::hal::replay {

/// Writes the frames of any depth camera as a scan set, decoded to 16-bit depth.
class Recorder {
 public:
  /// Errors:  a depth model that cannot be decoded; as ScanSetWriter::create().
  [[nodiscard]] static Loaded<Recorder> make(const depth::DepthModel& model,
                                             const std::filesystem::path& set);

  /// Adds a frame and, where the robot reported one, its pose.
  ///
  /// Errors:  a frame shorter than its model; as ScanSetWriter::add().
  [[nodiscard]] std::optional<LoadFault> add(const DepthFrame& frame,
                                             const std::optional<StampedPose>& pose);
  [[nodiscard]] std::optional<LoadFault> commit() { return writer_.commit(); }
  [[nodiscard]] std::size_t num_frames() const noexcept { return writer_.size(); }

 private:
  Recorder(const depth::FrameDecoder& decoder, bool has_gray, ScanSetWriter writer);

  depth::FrameDecoder decoder_;
  ScanSetWriter writer_;
  ScanView view_;
};

}  // namespace dseam::hal::replay
