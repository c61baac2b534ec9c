// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "dseam/depth/sample_layout.hpp"
#include "dseam/hal/camera/camera_info.hpp"
#include "dseam/hal/depth_camera.hpp"
#include "dseam/hal/v4l2/v4l2_sys.hpp"

namespace dseam::hal::v4l2 {

/// What to open, and what to ask of it; 0 leaves a setting as the device has it.
struct V4l2Config {
  std::string device;  ///< Best a name under /dev/v4l/by-id: numbers change with every replug.
  std::uint32_t fourcc = depth::fourcc('Z', '1', '6', ' ');
  /// A node of gray images, GREY or Y8, to be joined to its depth by PairedCamera.
  bool gray = false;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double frame_rate_hz = 0.0;
  std::uint32_t num_buffers = 6;
  /// V4L2 says nothing of units or lenses: scale, focal length and so on; the size is the device's.
  depth::DepthModel model;
  std::chrono::milliseconds lost_after{1000};  ///< Without a frame: reopen.
  std::chrono::milliseconds first_retry{200};  ///< Doubled up to 5 s.
};

/// What the device granted.
struct V4l2Grant {
  std::string card;
  std::string bus_info;
  std::uint32_t size_image = 0;
  std::uint32_t num_buffers = 0;
  double frame_rate_hz = 0.0;  ///< 0: it does not say.
};

enum class V4l2State : std::uint8_t { kIdle, kStreaming, kLost };

/// A depth camera of the Linux kernel, read through mapped buffers.
///
/// A thread of its own reopens the device when it fails or vanishes; frames are taken in the
/// caller's thread. Mappings that are out on loan outlive the device.
///
/// Memory:  the driver's buffers, mapped at open; no frame is copied.
class V4l2Camera final : public DepthCamera {
 public:
  /// Opens a camera. On failure `problem` says why, and what to do about it.
  ///
  /// Errors:  kNotFound, kUnavailable (busy, or not permitted), kUnsupported (another format than
  ///          asked), kInvalidArgument (a model that cannot be decoded), kIo.
  static Result<std::unique_ptr<V4l2Camera>> open(const V4l2Config& config, V4l2Sys& sys,
                                                  std::string& problem);
  ~V4l2Camera();

  [[nodiscard]] V4l2State state() const noexcept;
  [[nodiscard]] V4l2Grant grant() const;

 private:
  class Session;
  explicit V4l2Camera(std::unique_ptr<Session> session) noexcept;

  const depth::DepthModel& do_model() const noexcept override;
  Result<> do_start(FrameMode mode) noexcept override;
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override;
  void do_stop() noexcept override;
  CameraHealth do_health() const noexcept override;
  void do_give_back(std::uint32_t slot) noexcept override;

  std::unique_ptr<Session> session_;
};

/// Every video capture device, also those that give no depth.
[[nodiscard]] std::vector<CameraInfo> list_cameras(V4l2Sys& sys);

}  // namespace dseam::hal::v4l2
