// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstdint>
#include <string>

#include "dseam/base/result.hpp"
#include "dseam/hal/camera/slot_pool.hpp"
#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "dseam/hal/v4l2/v4l2_sys.hpp"

namespace dseam::hal::v4l2 {

/// One connection to a device: from open to close, without any way back from a failure.
class VideoStream {
 public:
  explicit VideoStream(V4l2Sys& sys) noexcept : sys_(sys) {}
  ~VideoStream() { close(); }
  VideoStream(const VideoStream&) = delete;
  VideoStream& operator=(const VideoStream&) = delete;

  /// Opens, negotiates and maps; everything but starting.
  Result<> open(const V4l2Config& config, std::string& problem);
  void close() noexcept;
  /// The mapping of a buffer; it is the caller's to unmap from here on.
  V4l2Sys::Mapping release(std::uint32_t index) noexcept;

  // Each returns 0 or a negative errno.
  int start() noexcept;
  int stop() noexcept;
  int queue(std::uint32_t index) noexcept;
  int dequeue(v4l2_buffer& buffer) noexcept;
  /// Poll's events, 0 when none came in time.
  int wait(int timeout_ms) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return fd_ >= 0; }
  [[nodiscard]] std::uint32_t num_buffers() const noexcept { return grant_.num_buffers; }
  [[nodiscard]] const V4l2Grant& grant() const noexcept { return grant_; }
  [[nodiscard]] const v4l2_pix_format& format() const noexcept { return format_; }

 private:
  int call(unsigned long request, void* argument) noexcept;
  Result<> identify(std::string& problem);
  Result<> set_format(const V4l2Config& config, std::string& problem);
  void set_frame_rate(const V4l2Config& config) noexcept;
  Result<> map_buffers(const V4l2Config& config, std::string& problem);
  [[nodiscard]] std::string offered_formats() noexcept;

  V4l2Sys& sys_;
  int fd_ = -1;
  V4l2Grant grant_;
  v4l2_pix_format format_{};
  std::array<V4l2Sys::Mapping, SlotPool::kMaxSlots> mappings_{};
};

/// The error of a failed call, and its text with the cure.
Errc explain(int error, const std::string& what, std::string& problem);

}  // namespace dseam::hal::v4l2
