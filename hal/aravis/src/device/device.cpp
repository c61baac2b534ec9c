// SPDX-License-Identifier: Apache-2.0
#include "device/device.hpp"

#include <sys/socket.h>

#include <algorithm>

#include "device/scan3d.hpp"
#include "dseam/depth/sample_layout.hpp"

namespace dseam::hal::aravis {
namespace {

std::string seen_cameras() {
  std::string seen;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    seen += (seen.empty() ? "" : ", ") + std::string(arv_get_device_id(i));
  }
  return seen.empty() ? "none" : seen;
}

/// The id by which Aravis opens what the user named: a serial number is not one.
std::string device_id_of(const std::string& named) {
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    const char* serial = arv_get_device_serial_nbr(i);
    if (serial != nullptr && named == serial) {
      return arv_get_device_id(i);
    }
  }
  return named;
}

Result<> apply_settings(ArvCamera* camera, const AravisConfig& config, AravisSys& sys,
                        std::string& problem) {
  GlibError error;
  const std::string format =
      config.gray && config.pixel_format.empty() ? "Mono8" : config.pixel_format;
  if (!format.empty()) {
    sys.set_text(camera, "PixelFormat", format.c_str(), error.out());
    if (error) {
      problem = "it has no pixel format " + format + " (" + error.text() + ")";
      return Errc::kUnsupported;
    }
  }
  if (config.frame_rate_hz > 0.0) {
    sys.set_frame_rate_hz(camera, config.frame_rate_hz, error.out());
    if (error) {
      problem = "it refused the frame rate: " + error.text();
      return Errc::kUnsupported;
    }
  }
  return {};
}

/// Selects a component of what the camera sees, and has it sent.
bool send_component(ArvCamera* camera, const char* component, AravisSys& sys, GlibError& error) {
  sys.set_text(camera, "ComponentSelector", component, error.out());
  if (!error) {
    sys.set_flag(camera, "ComponentEnable", true, error.out());
  }
  return !error;
}

/// Depth and gray in one frame. The selector stays on the depth, so that what is set and read
/// afterwards is the depth's.
///
/// Source:  GenICam SFNC 2.7, ComponentSelector; GigE Vision 2.0, multipart payload.
Result<> ask_for_both_images(Device& device, AravisSys& sys, std::string& problem) {
  ArvCamera* camera = device.camera.get();
  GlibError error;
  bool both = send_component(camera, "Intensity", sys, error);
  if (both) {
    sys.set_text(camera, "PixelFormat", "Mono8", error.out());
    both = !error;
  }
  both = both && (send_component(camera, "Range", sys, error) ||
                  send_component(camera, "Disparity", sys, error));
  if (both && device.is_gige) {
    sys.set_multipart(camera, error.out());
  }
  if (error) {
    problem = "it does not send a gray image beside its depth (" + error.text() +
              "); name a second camera in camera.gray_device, or do without";
    return Errc::kUnsupported;
  }
  return {};
}

void choose_packet_size(Device& device, const AravisConfig& config, AravisSys& sys) {
  constexpr std::uint32_t kSmallest = 576;
  constexpr std::uint32_t kSafe = 1400;
  ArvCamera* camera = device.camera.get();
  GlibError error;
  std::uint32_t granted = sys.set_packet_bytes(camera, config.packet_bytes, error.out());
  if (error || granted < kSmallest) {
    granted = sys.set_packet_bytes(camera, kSafe, error.out());
  }
  device.grant.packet_bytes = granted;
  constexpr std::uint32_t kJumbo = 8000;
  if (granted < kJumbo) {
    device.grant.notes.push_back("packets of " + std::to_string(granted) +
                                 " bytes: set the network card's MTU to 9000 "
                                 "(ip link set IFACE mtu 9000)");
  }
}

/// What the kernel gave the receiving socket, which is found by its port.
std::size_t receive_buffer_of_port(std::uint16_t port) {
  const auto sockets = own_udp_sockets();
  const auto found = std::ranges::find(sockets, port, &OwnSocket::port);
  int granted = 0;
  socklen_t size = sizeof granted;
  if (found != sockets.end()) {
    (void)getsockopt(found->fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  }
  return static_cast<std::size_t>(granted) / 2;  // The kernel doubles it for its bookkeeping.
}

/// The frame's own size counts too: a buffer that holds none of it loses packets under load.
std::size_t wanted_socket_buffer(const Device& device, const AravisConfig& config) {
  return std::clamp(3 * device.payload_bytes, config.socket_buffer_bytes, std::size_t{1} << 30U);
}

/// Reads what the camera says of its images, and whether that can be.
Result<> describe(Device& device, const AravisConfig& config, AravisSys& sys,
                  std::string& problem) {
  ArvCamera* camera = device.camera.get();
  auto model = config.gray ? read_gray_model(camera, sys, problem)
                           : read_depth_model(camera, sys, config.assumed_model, problem);
  if (!model.ok()) {
    return model.error();
  }
  GlibError error;
  device.model = model.value();
  device.model.has_gray = config.gray || config.gray_beside_depth;
  device.payload_bytes = static_cast<std::size_t>(
      std::max<std::int64_t>(0, sys.integer(camera, "PayloadSize", error.out())));
  const double rate_hz = sys.frame_rate_hz(camera, error.out());
  device.period_s = rate_hz > 0.01 ? 1.0 / rate_hz : device.period_s;
  const std::size_t image_bytes =
      (config.gray ? 0 : depth::depth_bytes(device.model)) + depth::gray_bytes(device.model);
  if (device.payload_bytes < image_bytes) {
    problem = "its payload of " + std::to_string(device.payload_bytes) +
              " bytes cannot hold the image it describes";
    return Errc::kBadData;
  }
  return {};
}

Result<Device> open_camera(const AravisConfig& config, AravisSys& sys, ControlLine& line,
                           std::string& problem) {
  if (config.id.starts_with("Fake")) {
    arv_enable_interface("Fake");
  }
  sys.find_devices();
  const auto sockets = own_udp_sockets();
  Device device;
  GlibError error;
  device.camera.reset(sys.open(device_id_of(config.id).c_str(), error.out()));
  if (device.camera == nullptr) {
    problem = "there is no camera " + config.id + " (seen: " + seen_cameras() +
              "); check power, cable and the network card's address: " + error.text();
    return Errc::kNotFound;
  }
  device.is_gige = arv_camera_is_gv_device(device.camera.get()) != FALSE;
  if (device.is_gige) {
    line.hold_the_new_one(sockets);
  }
  if (!sys.controls(device.camera.get())) {
    problem =
        "another program controls it; end that program (after a crash the camera frees "
        "itself within 3 s)";
    return Errc::kUnavailable;
  }
  return device;
}

}  // namespace

Result<Device> connect(const AravisConfig& config, AravisSys& sys, ControlLine& line,
                       std::string& problem) {
  auto opened = open_camera(config, sys, line, problem);
  if (!opened.ok()) {
    return opened.error();
  }
  Device& device = opened.value();
  if (config.gray_beside_depth) {
    if (const auto asked = ask_for_both_images(device, sys, problem); !asked.ok()) {
      return asked.error();
    }
  }
  if (const auto applied = apply_settings(device.camera.get(), config, sys, problem);
      !applied.ok()) {
    return applied.error();
  }
  if (const auto described = describe(device, config, sys, problem); !described.ok()) {
    return described.error();
  }
  return opened;
}

Result<> make_stream(Device& device, const AravisConfig& config, AravisSys& sys,
                     std::string& problem) {
  AravisSys::StreamSettings settings;
  settings.receive_priority = config.receive_priority;
  if (device.is_gige) {
    choose_packet_size(device, config, sys);
    settings.socket_buffer_bytes = wanted_socket_buffer(device, config);
  }
  GlibError error;
  device.stream.reset(sys.make_stream(device.camera.get(), settings, error.out()));
  if (device.stream == nullptr) {
    problem = "it gave no stream: " + error.text();
    return error.is(ARV_DEVICE_ERROR_NOT_CONTROLLER) ? Errc::kUnavailable : Errc::kIo;
  }
  return {};
}

void read_back_socket_buffer(Device& device, const AravisConfig& config) {
  if (!device.is_gige) {
    return;
  }
  const std::size_t wanted = wanted_socket_buffer(device, config);
  const std::uint16_t port = arv_gv_stream_get_port(ARV_GV_STREAM(device.stream.get()));
  device.grant.socket_buffer_bytes = receive_buffer_of_port(port);
  if (device.grant.socket_buffer_bytes < wanted) {
    device.grant.notes.push_back(
        "the socket buffer is " + std::to_string(device.grant.socket_buffer_bytes) + " of " +
        std::to_string(wanted) + " bytes: frames are lost under load; sysctl -w " +
        "net.core.rmem_max=" + std::to_string(wanted));
  }
}

}  // namespace dseam::hal::aravis
