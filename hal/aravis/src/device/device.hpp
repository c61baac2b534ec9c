// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "device/control_line.hpp"
#include "device/glib_ptr.hpp"
#include "dseam/hal/aravis/aravis_camera.hpp"
#include "dseam/hal/aravis/aravis_sys.hpp"

namespace dseam::hal::aravis {

/// One connection to a camera, with every setting applied. Made and used by the control thread.
struct Device {
  ObjectPtr<ArvCamera> camera;
  ObjectPtr<ArvStream> stream;
  depth::DepthModel model;
  std::size_t payload_bytes = 0;  ///< What the device sends a frame.
  double period_s = 1.0 / 30.0;
  bool is_gige = false;
  AravisGrant grant;
};

/// Connects and applies `config`; makes no stream yet. `line` holds the way to the camera.
Result<Device> connect(const AravisConfig& config, AravisSys& sys, ControlLine& line,
                       std::string& problem);

/// Makes the stream.
///
/// Errors:  kUnavailable: another program controls the camera. kIo: anything else.
Result<> make_stream(Device& device, const AravisConfig& config, AravisSys& sys,
                     std::string& problem);

/// Notes what the socket got; Aravis sets it when the first frame begins, so after that.
void read_back_socket_buffer(Device& device, const AravisConfig& config);

}  // namespace dseam::hal::aravis
