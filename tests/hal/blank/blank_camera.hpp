// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

#include "dseam/hal/camera/camera_counters.hpp"
#include "dseam/hal/depth_camera.hpp"

namespace dseam::hal::blank {

/// A camera without a device, to begin a backend from: every function, and the rules that hold
/// for each; docs/porting.md goes through them.
class BlankCamera final : public DepthCamera {
 public:
  explicit BlankCamera(const depth::DepthModel& model) noexcept : model_(model) {}

 private:
  /// What the device said at open.
  const depth::DepthModel& do_model() const noexcept override { return model_; }

  Result<> do_start(FrameMode /*mode*/) noexcept override {
    return running_.exchange(true) ? Result<>(Errc::kUnavailable) : Result<>();
  }

  /// Returns a lease of one of the device's buffers; waits in short slices, so that stop() and the
  /// thread that reconnects get in between.
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override {
    if (!running_) {
      return Errc::kUnavailable;
    }
    std::this_thread::sleep_for(timeout);
    return Errc::kTimeout;
  }

  /// Never calls into a device library that may block.
  void do_stop() noexcept override { running_ = false; }

  CameraHealth do_health() const noexcept override { return counters_.snapshot(); }

  /// From any thread, also after stop() and while the device is gone.
  void do_give_back(std::uint32_t /*slot*/) noexcept override {}

  depth::DepthModel model_;
  CameraCounters counters_;
  std::atomic<bool> running_{false};
};

}  // namespace dseam::hal::blank
