// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dseam/hal/aravis/aravis_sys.hpp"
#include "dseam/hal/camera/camera_info.hpp"
#include "dseam/hal/depth_camera.hpp"

namespace dseam::hal::aravis {

/// What to open, and what to ask of it; 0 or empty leaves a setting as the device has it.
struct AravisConfig {
  std::string id;  ///< Serial number, Aravis' device id or address. "Fake_1": Aravis' own fake.
  std::string pixel_format;
  /// A camera of gray images, Mono8, to be joined to another's depth by PairedCamera.
  bool gray = false;
  /// Ask the camera for its own gray image too, in one frame with its depth (multipart).
  bool gray_beside_depth = false;
  double frame_rate_hz = 0.0;
  std::uint32_t num_buffers = 8;
  std::uint32_t packet_bytes = 0;  ///< 0: as large as the path carries, found at open.
  std::size_t socket_buffer_bytes = std::size_t{16} << 20U;
  int receive_priority = 0;      ///< SCHED_FIFO priority of Aravis' receiving thread.
  double stalled_periods = 3.0;  ///< Without a frame: kStalled.
  double lost_periods = 10.0;    ///< Without a frame, and at least 500 ms: reconnect.
  std::chrono::milliseconds first_frame{1000};  ///< Then packets of 1400 bytes are tried.
  std::chrono::milliseconds first_retry{200};   ///< Of a reconnection; doubled up to 5 s.
  /// Used when the device itself describes no 3D data; width, height and format are the device's.
  std::optional<depth::DepthModel> assumed_model;
};

/// What the device and this computer granted.
struct AravisGrant {
  std::uint32_t packet_bytes = 0;
  std::size_t socket_buffer_bytes = 0;  ///< As read back from the socket.
  std::vector<std::string> notes;       ///< What is worse than asked for, each with its cure.
};

enum class AravisState : std::uint8_t { kIdle, kStreaming, kStalled, kLost };

/// A GenICam camera (GigE Vision, USB3 Vision) through Aravis 0.8.26 or later.
///
/// Three threads: Aravis' own receives, one of ours makes every control call (each may block for
/// 2.5 s when the device is gone) and reconnects, and the caller's takes frames.
///
/// Memory:  one mapping with `num_buffers` frames, filled by Aravis in place. Aravis' receiving
///          thread allocates about 3 kB a frame; the caller's thread nothing.
/// Time:    stop() returns at once; the destructor within 6 s, also when the device is gone: it
///          waits 3 s for Aravis and then cuts the line on which that waits for answers.
class AravisCamera final : public DepthCamera {
 public:
  /// Opens a camera. On failure `problem` says why, and what to do about it.
  ///
  /// Errors:  kNotFound, kUnavailable (in use), kUnsupported (no depth format, or no 3D
  ///          description and no assumed model), kIo.
  static Result<std::unique_ptr<AravisCamera>> open(const AravisConfig& config,
                                                    std::string& problem);
  /// The same over another table of calls, which must outlive the camera.
  static Result<std::unique_ptr<AravisCamera>> open(const AravisConfig& config, AravisSys& sys,
                                                    std::string& problem);
  ~AravisCamera();

  [[nodiscard]] AravisState state() const noexcept;
  [[nodiscard]] AravisGrant grant() const;

 private:
  class Session;
  explicit AravisCamera(std::unique_ptr<Session> session) noexcept;

  const depth::DepthModel& do_model() const noexcept override;
  Result<> do_start(FrameMode mode) noexcept override;
  Result<FrameLease> do_next(std::chrono::nanoseconds timeout) noexcept override;
  void do_stop() noexcept override;
  CameraHealth do_health() const noexcept override;
  void do_give_back(std::uint32_t slot) noexcept override;

  std::unique_ptr<Session> session_;
};

/// Every camera that Aravis can see; each is opened for a moment to learn whether it can be.
///
/// Time:    about a second for the discovery on the network.
[[nodiscard]] std::vector<CameraInfo> list_cameras();

}  // namespace dseam::hal::aravis
