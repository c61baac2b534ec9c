// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "device/glib_ptr.hpp"
#include "dseam/hal/aravis/aravis_sys.hpp"

namespace dseam::hal::aravis {
namespace {

ArvGvDevice* gige_device(ArvCamera* camera) { return ARV_GV_DEVICE(arv_camera_get_device(camera)); }

bool on_loopback(ArvCamera* camera) {
  GSocketAddress* address = arv_gv_device_get_interface_address(gige_device(camera));  // Lent.
  return g_inet_address_get_is_loopback(
             g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))) != FALSE;
}

void on_stream_event(void* user_data, ArvStreamCallbackType type, ArvBuffer* /*buffer*/) {
  const int priority = GPOINTER_TO_INT(user_data);
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT && priority > 0) {
    arv_make_thread_realtime(priority);
  }
}

/// Retention: a busy computer may hold a frame's packets back for several periods.
void set_gige_stream(ArvStream* stream, std::size_t socket_buffer_bytes) {
  g_object_set(stream, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               static_cast<gint>(socket_buffer_bytes), "packet-resend",
               ARV_GV_STREAM_PACKET_RESEND_ALWAYS, "initial-packet-timeout", 2000U,
               "packet-timeout", 20'000U, "frame-retention", 100'000U, nullptr);
}

bool has_images(ArvBuffer* buffer) {
  const ArvBufferPayloadType type = arv_buffer_get_payload_type(buffer);
  return type == ARV_BUFFER_PAYLOAD_TYPE_IMAGE || type == ARV_BUFFER_PAYLOAD_TYPE_MULTIPART ||
         type == ARV_BUFFER_PAYLOAD_TYPE_EXTENDED_CHUNK_DATA;
}

AravisSys::Part part_of(ArvBuffer* buffer, guint index) {
  AravisSys::Part part;
  part.data =
      static_cast<const std::byte*>(arv_buffer_get_part_data(buffer, index, &part.size_bytes));
  part.pixel_format = arv_buffer_get_part_pixel_format(buffer, index);
  part.width = static_cast<std::uint32_t>(arv_buffer_get_part_width(buffer, index));
  part.height = static_cast<std::uint32_t>(arv_buffer_get_part_height(buffer, index));
  gint row_padding = 0;
  gint frame_padding = 0;
  arv_buffer_get_part_padding(buffer, index, &row_padding, &frame_padding);
  part.row_padding_bytes = static_cast<std::uint32_t>(row_padding);
  return part;
}

class Library final : public AravisSys {
  void find_devices() noexcept override { arv_update_device_list(); }
  Camera* open(const char* id, Error** error) noexcept override {
    return arv_camera_new(id, error);
  }
  bool controls(Camera* camera) noexcept override {
    return arv_camera_is_gv_device(camera) == FALSE ||
           arv_gv_device_is_controller(gige_device(camera)) != FALSE;
  }

  bool has(Camera* camera, const char* feature, Error** error) noexcept override {
    return arv_camera_is_feature_available(camera, feature, error) != FALSE;
  }
  double number(Camera* camera, const char* feature, Error** error) noexcept override {
    return arv_camera_get_float(camera, feature, error);
  }
  std::int64_t integer(Camera* camera, const char* feature, Error** error) noexcept override {
    return arv_camera_get_integer(camera, feature, error);
  }
  bool flag(Camera* camera, const char* feature, Error** error) noexcept override {
    return arv_camera_get_boolean(camera, feature, error) != FALSE;
  }
  const char* text(Camera* camera, const char* feature, Error** error) noexcept override {
    return arv_camera_get_string(camera, feature, error);
  }
  void set_flag(Camera* camera, const char* feature, bool on, Error** error) noexcept override {
    arv_camera_set_boolean(camera, feature, on ? TRUE : FALSE, error);
  }
  void set_text(Camera* camera, const char* feature, const char* value,
                Error** error) noexcept override {
    arv_camera_set_string(camera, feature, value, error);
  }
  double frame_rate_hz(Camera* camera, Error** error) noexcept override {
    return arv_camera_get_frame_rate(camera, error);
  }
  void set_frame_rate_hz(Camera* camera, double rate_hz, Error** error) noexcept override {
    arv_camera_set_frame_rate(camera, rate_hz, error);
  }
  void set_multipart(Camera* camera, Error** error) noexcept override {
    arv_camera_gv_set_multipart(camera, TRUE, error);
  }
  std::uint32_t set_packet_bytes(Camera* camera, std::uint32_t wanted,
                                 Error** error) noexcept override {
    if (wanted == 0) {
      return arv_camera_gv_auto_packet_size(camera, error);
    }
    arv_camera_gv_set_packet_size(camera, static_cast<gint>(wanted), error);
    return arv_camera_gv_get_packet_size(camera, nullptr);
  }

  /// As root, Aravis chooses a packet socket by itself, which receives nothing on the loopback.
  Stream* make_stream(Camera* camera, const StreamSettings& settings,
                      Error** error) noexcept override {
    const bool gige = settings.socket_buffer_bytes != 0;
    if (gige && on_loopback(camera)) {
      arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    }
    ArvStream* stream = arv_camera_create_stream(camera, on_stream_event,
                                                 GINT_TO_POINTER(settings.receive_priority), error);
    if (gige && stream != nullptr) {
      set_gige_stream(stream, settings.socket_buffer_bytes);
    }
    return stream;
  }
  void start(Camera* camera, Error** error) noexcept override {
    arv_camera_start_acquisition(camera, error);
  }
  void stop(Camera* camera, Error** error) noexcept override {
    arv_camera_stop_acquisition(camera, error);
  }
  std::uint64_t count(Stream* stream, const char* counter) noexcept override {
    return arv_stream_get_info_uint64_by_name(stream, counter);
  }
  Buffer* pop(Stream* stream, std::uint64_t timeout_us) noexcept override {
    return timeout_us == 0 ? arv_stream_try_pop_buffer(stream)
                           : arv_stream_timeout_pop_buffer(stream, timeout_us);
  }
  void push(Stream* stream, Buffer* buffer) noexcept override {
    arv_stream_push_buffer(stream, buffer);
  }
  Arrival arrival(Buffer* buffer) noexcept override {
    return {.status = arv_buffer_get_status(buffer),
            .frame_id = arv_buffer_get_frame_id(buffer),
            .device_ns = arv_buffer_get_timestamp(buffer),
            .system_ns = arv_buffer_get_system_timestamp(buffer)};
  }
  std::size_t parts(Buffer* buffer, std::span<Part> out) noexcept override {
    const std::size_t count = has_images(buffer) ? arv_buffer_get_n_parts(buffer) : 0;
    const std::size_t filled = std::min(count, out.size());
    for (std::size_t i = 0; i < filled; ++i) {
      out[i] = part_of(buffer, static_cast<guint>(i));
    }
    return filled;
  }
};

}  // namespace

AravisSys& aravis_library() noexcept {
  static Library library;
  return library;
}

}  // namespace dseam::hal::aravis
