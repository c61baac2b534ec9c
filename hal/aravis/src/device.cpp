// SPDX-License-Identifier: Apache-2.0
#include "device.hpp"

#include <gio/gio.h>
#include <netinet/in.h>
#include <sys/mman.h>
#include <sys/socket.h>

#include <algorithm>
#include <filesystem>

#include "dseam/depth/sample_layout.hpp"
#include "scan3d.hpp"

namespace dseam::hal::aravis {
namespace {

bool on_loopback(ArvGvDevice* device) {
  GSocketAddress* address = arv_gv_device_get_interface_address(device);  // Still the device's.
  return g_inet_address_get_is_loopback(
             g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))) != FALSE;
}

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

Result<> apply_settings(ArvCamera* camera, const AravisConfig& config, std::string& problem) {
  GlibError error;
  const std::string format =
      config.gray && config.pixel_format.empty() ? "Mono8" : config.pixel_format;
  if (!format.empty()) {
    arv_camera_set_pixel_format_from_string(camera, format.c_str(), error.out());
    if (error) {
      problem = "it has no pixel format " + format + " (" + error.text() + ")";
      return Errc::kUnsupported;
    }
  }
  if (config.frame_rate_hz > 0.0) {
    arv_camera_set_frame_rate(camera, config.frame_rate_hz, error.out());
    if (error) {
      problem = "it refused the frame rate: " + error.text();
      return Errc::kUnsupported;
    }
  }
  return {};
}

/// As root, Aravis chooses a packet socket by itself, and that receives nothing on the loopback.
void choose_socket_kind(Device& device) {
  if (on_loopback(ARV_GV_DEVICE(arv_camera_get_device(device.camera.get())))) {
    arv_camera_gv_set_stream_options(device.camera.get(),
                                     ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  }
}

void choose_packet_size(Device& device, const AravisConfig& config) {
  constexpr guint kSmallest = 576;
  constexpr gint kSafe = 1400;
  ArvCamera* camera = device.camera.get();
  GlibError error;
  if (config.packet_bytes != 0) {
    arv_camera_gv_set_packet_size(camera, static_cast<gint>(config.packet_bytes), error.out());
  } else if (arv_camera_gv_auto_packet_size(camera, error.out()) < kSmallest || error) {
    arv_camera_gv_set_packet_size(camera, kSafe, error.out());
  }
  device.grant.packet_bytes = arv_camera_gv_get_packet_size(camera, error.out());
  constexpr std::uint32_t kJumbo = 8000;
  if (device.grant.packet_bytes < kJumbo) {
    device.grant.notes.push_back("packets of " + std::to_string(device.grant.packet_bytes) +
                                 " bytes: set the network card's MTU to 9000 "
                                 "(ip link set IFACE mtu 9000)");
  }
}

/// What the kernel gave the receiving socket, which is found by its port.
std::size_t receive_buffer_of_port(std::uint16_t port) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    sockaddr_in address{};
    socklen_t size = sizeof address;
    int granted = 0;
    socklen_t granted_size = sizeof granted;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&  // NOLINT: POSIX
        address.sin_family == AF_INET && ntohs(address.sin_port) == port &&
        getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &granted_size) == 0) {
      return static_cast<std::size_t>(granted) / 2;  // The kernel doubles it for its bookkeeping.
    }
  }
  return 0;
}

/// The frame's own size counts too: a buffer that holds none of it loses packets under load.
std::size_t wanted_socket_buffer(const Device& device, const AravisConfig& config) {
  return std::clamp(3 * device.payload_bytes, config.socket_buffer_bytes, std::size_t{1} << 30U);
}

void on_stream_event(void* user_data, ArvStreamCallbackType type, ArvBuffer* /*buffer*/) {
  const int priority = GPOINTER_TO_INT(user_data);
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT && priority > 0) {
    arv_make_thread_realtime(priority);
  }
}

/// Retention: a busy computer may hold a frame's packets back for several periods.
void set_gige_stream(ArvStream* stream, std::size_t socket_buffer) {
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               static_cast<gint>(socket_buffer), "packet-resend",
               ARV_GV_STREAM_PACKET_RESEND_ALWAYS, "initial-packet-timeout", 2000U,
               "packet-timeout", 20'000U, "frame-retention", 100'000U, nullptr);
}

}  // namespace

FramePool::~FramePool() {
  if (memory_ != nullptr) {
    munmap(memory_, slot_bytes_ * slots_);
  }
}

Result<> FramePool::map(std::uint32_t slots, std::size_t payload_bytes) {
  constexpr std::size_t kPage = 4096;
  slots_ = slots;
  payload_bytes_ = payload_bytes;
  slot_bytes_ = (payload_bytes + kPage - 1) / kPage * kPage;
  void* memory = mmap(nullptr, slot_bytes_ * slots_, PROT_READ | PROT_WRITE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (memory == MAP_FAILED) {
    return Errc::kOutOfMemory;
  }
  memory_ = static_cast<std::byte*>(memory);
  return {};
}

/// Reads what the camera says of its images, and whether that can be.
Result<> describe(Device& device, const AravisConfig& config, std::string& problem) {
  ArvCamera* camera = device.camera.get();
  auto model = config.gray ? read_gray_model(camera, problem)
                           : read_depth_model(camera, config.assumed_model, problem);
  if (!model.ok()) {
    return model.error();
  }
  GlibError error;
  device.model = model.value();
  device.image_bytes =
      config.gray ? depth::gray_bytes(device.model) : depth::depth_bytes(device.model);
  device.payload_bytes = arv_camera_get_payload(camera, error.out());
  const double rate_hz = arv_camera_get_frame_rate(camera, error.out());
  device.period_s = rate_hz > 0.01 ? 1.0 / rate_hz : device.period_s;
  if (device.payload_bytes < device.image_bytes) {
    problem = "its payload of " + std::to_string(device.payload_bytes) +
              " bytes cannot hold the image it describes";
    return Errc::kBadData;
  }
  return {};
}

Result<Device> connect(const AravisConfig& config, std::string& problem) {
  if (config.id.starts_with("Fake")) {
    arv_enable_interface("Fake");
  }
  arv_update_device_list();
  Device device;
  GlibError error;
  device.camera.reset(arv_camera_new(device_id_of(config.id).c_str(), error.out()));
  if (device.camera == nullptr) {
    problem = "there is no camera " + config.id + " (seen: " + seen_cameras() +
              "); check power, cable and the network card's address: " + error.text();
    return Errc::kNotFound;
  }
  ArvCamera* camera = device.camera.get();
  device.is_gige = arv_camera_is_gv_device(camera) != FALSE;
  if (device.is_gige &&
      arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(camera))) == FALSE) {
    problem =
        "another program controls it; end that program (after a crash the camera frees "
        "itself within 3 s)";
    return Errc::kUnavailable;
  }
  if (const auto applied = apply_settings(camera, config, problem); !applied.ok()) {
    return applied.error();
  }
  if (const auto described = describe(device, config, problem); !described.ok()) {
    return described.error();
  }
  return device;
}

Result<> make_stream(Device& device, const AravisConfig& config, std::string& problem) {
  GlibError error;
  if (device.is_gige) {
    choose_socket_kind(device);
    choose_packet_size(device, config);
  }
  device.stream.reset(arv_camera_create_stream(
      device.camera.get(), on_stream_event, GINT_TO_POINTER(config.receive_priority), error.out()));
  if (device.stream == nullptr) {
    problem = "it gave no stream: " + error.text();
    return error.is(ARV_DEVICE_ERROR_NOT_CONTROLLER) ? Errc::kUnavailable : Errc::kIo;
  }
  if (device.is_gige) {
    set_gige_stream(device.stream.get(), wanted_socket_buffer(device, config));
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
