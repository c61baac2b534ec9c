// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Aravis' and GLib's own types, so that this header asks for neither.
struct _ArvBuffer;  // NOLINT(bugprone-reserved-identifier): the library's name.
struct _ArvCamera;  // NOLINT(bugprone-reserved-identifier)
struct _ArvStream;  // NOLINT(bugprone-reserved-identifier)
struct _GError;     // NOLINT(bugprone-reserved-identifier)

namespace dseam::hal::aravis {

/// The calls into Aravis that this backend makes and that can fail, so that a test can let the n-th
/// of them fail.
///
/// Errors:  a call that fails sets its `error` and returns zero.
/// Context: pop(), push(), arrival() and parts() also from the consumer's thread.
class AravisSys {
 public:
  using Camera = _ArvCamera;
  using Stream = _ArvStream;
  using Buffer = _ArvBuffer;
  using Error = _GError;

  AravisSys() = default;
  AravisSys(const AravisSys&) = delete;
  AravisSys& operator=(const AravisSys&) = delete;

  struct StreamSettings {
    int receive_priority = 0;             ///< SCHED_FIFO priority of the receiving thread.
    std::size_t socket_buffer_bytes = 0;  ///< 0: no GigE Vision camera.
  };

  /// What came. Frames that are not whole may hold anything.
  struct Arrival {
    int status = 0;  ///< ArvBufferStatus; 0 is whole.
    std::uint64_t frame_id = 0;
    std::uint64_t device_ns = 0;  ///< The camera's clock.
    std::uint64_t system_ns = 0;  ///< The wall clock when the first packet came.
  };

  /// One image of a frame; a frame of a single image has one part.
  struct Part {
    const std::byte* data = nullptr;
    std::size_t size_bytes = 0;  ///< 0: Aravis' own fake does not say.
    std::uint32_t pixel_format = 0;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t row_padding_bytes = 0;
  };

  /// Looks for cameras on every interface; may take a second.
  virtual void find_devices() noexcept = 0;
  virtual Camera* open(const char* id, Error** error) noexcept = 0;
  /// Whether this program may change the camera; another one may hold it.
  virtual bool controls(Camera* camera) noexcept = 0;

  virtual bool has(Camera* camera, const char* feature, Error** error) noexcept = 0;
  virtual double number(Camera* camera, const char* feature, Error** error) noexcept = 0;
  virtual std::int64_t integer(Camera* camera, const char* feature, Error** error) noexcept = 0;
  virtual bool flag(Camera* camera, const char* feature, Error** error) noexcept = 0;
  virtual const char* text(Camera* camera, const char* feature, Error** error) noexcept = 0;
  virtual void set_flag(Camera* camera, const char* feature, bool on, Error** error) noexcept = 0;
  virtual void set_text(Camera* camera, const char* feature, const char* value,
                        Error** error) noexcept = 0;
  virtual double frame_rate_hz(Camera* camera, Error** error) noexcept = 0;
  virtual void set_frame_rate_hz(Camera* camera, double rate_hz, Error** error) noexcept = 0;
  /// GigE Vision: several images in one frame.
  virtual void set_multipart(Camera* camera, Error** error) noexcept = 0;
  /// GigE Vision: the size granted; for 0 as large as the path carries.
  virtual std::uint32_t set_packet_bytes(Camera* camera, std::uint32_t wanted,
                                         Error** error) noexcept = 0;

  virtual Stream* make_stream(Camera* camera, const StreamSettings& settings,
                              Error** error) noexcept = 0;
  virtual void start(Camera* camera, Error** error) noexcept = 0;
  virtual void stop(Camera* camera, Error** error) noexcept = 0;
  /// One of the stream's own counters.
  virtual std::uint64_t count(Stream* stream, const char* counter) noexcept = 0;
  /// The oldest frame, or null when none came in time.
  virtual Buffer* pop(Stream* stream, std::uint64_t timeout_us) noexcept = 0;
  virtual void push(Stream* stream, Buffer* buffer) noexcept = 0;
  virtual Arrival arrival(Buffer* buffer) noexcept = 0;
  /// The images of a whole frame: how many of `out` were filled.
  virtual std::size_t parts(Buffer* buffer, std::span<Part> out) noexcept = 0;

 protected:
  ~AravisSys() = default;
};

/// The library itself.
[[nodiscard]] AravisSys& aravis_library() noexcept;

}  // namespace dseam::hal::aravis
