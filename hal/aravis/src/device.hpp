// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "glib_ptr.hpp"

namespace dseam::hal::aravis {

/// The buffers that frames arrive in: one mapping, made before the first frame.
class FramePool {
 public:
  FramePool() = default;
  FramePool(const FramePool&) = delete;
  FramePool& operator=(const FramePool&) = delete;
  ~FramePool();

  Result<> map(std::uint32_t slots, std::size_t payload_bytes);
  [[nodiscard]] std::byte* slot(std::uint32_t index) const noexcept {
    return memory_ + index * slot_bytes_;
  }
  [[nodiscard]] std::uint32_t num_slots() const noexcept { return slots_; }
  [[nodiscard]] std::size_t payload_bytes() const noexcept { return payload_bytes_; }

 private:
  std::byte* memory_ = nullptr;
  std::size_t slot_bytes_ = 0;
  std::size_t payload_bytes_ = 0;
  std::uint32_t slots_ = 0;
};

/// One connection to a camera, with every setting applied. Made and used by the control thread.
struct Device {
  ObjectPtr<ArvCamera> camera;
  ObjectPtr<ArvStream> stream;
  depth::DepthModel model;
  std::size_t payload_bytes = 0;  ///< What the device sends a frame,
  std::size_t image_bytes = 0;    ///< and what of it is needed.
  double period_s = 1.0 / 30.0;
  bool is_gige = false;
  AravisGrant grant;
};

/// Connects and applies `config`; makes no stream yet.
Result<Device> connect(const AravisConfig& config, std::string& problem);

/// Makes the stream.
///
/// Errors:  kUnavailable: another program controls the camera. kIo: anything else.
Result<> make_stream(Device& device, const AravisConfig& config, std::string& problem);

/// Notes what the socket got; Aravis sets it when the first frame begins, so after that.
void read_back_socket_buffer(Device& device, const AravisConfig& config);

}  // namespace dseam::hal::aravis
