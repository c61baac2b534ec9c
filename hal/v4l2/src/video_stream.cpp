// SPDX-License-Identifier: Apache-2.0
#include "video_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace dseam::hal::v4l2 {
namespace {

constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr int kInterruptions = 16;  // A signal may interrupt a call, but not for ever.

std::string name_of(std::uint32_t code) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    const char letter = static_cast<char>((code >> shift) & 0x7FU);
    text += letter < ' ' ? '?' : letter;
  }
  return text;
}

template <std::size_t N>
std::string text_of(const __u8 (&field)[N]) {
  std::string text;
  for (std::size_t i = 0; i < N && field[i] != 0; ++i) {
    text += static_cast<char>(field[i]);
  }
  return text;
}

}  // namespace

Errc explain(int error, const std::string& what, std::string& problem) {
  const int code = -error;
  problem = what + ": " + std::strerror(code);
  switch (code) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      problem += "; see ls -l /dev/v4l/by-id, and dmesg for why it vanished";
      return Errc::kNotFound;
    case EACCES:
    case EPERM:
      problem += "; add the user to the group video (usermod -aG video USER) and log in again";
      return Errc::kUnavailable;
    case EBUSY:
      problem += "; another program streams from it (fuser -v DEVICE names it)";
      return Errc::kUnavailable;
    case ENOMEM:
    case ENOBUFS:
      problem += "; ask for fewer or smaller buffers";
      return Errc::kOutOfMemory;
    case ENOTTY:
      problem += "; it is no video capture device";
      return Errc::kUnsupported;
    default:
      return Errc::kIo;
  }
}

Result<> VideoStream::open(const V4l2Config& config, std::string& problem) {
  fd_ = sys_.open(config.device.c_str());
  if (fd_ < 0) {
    return explain(std::exchange(fd_, -1), config.device + " cannot be opened", problem);
  }
  if (const auto known = identify(problem); !known.ok()) {
    return known;
  }
  if (const auto agreed = set_format(config, problem); !agreed.ok()) {
    return agreed;
  }
  set_frame_rate(config);
  return map_buffers(config, problem);
}

void VideoStream::close() noexcept {
  for (std::uint32_t i = 0; i < mappings_.size(); ++i) {
    if (mappings_[i].start != nullptr) {
      (void)sys_.unmap(release(i));
    }
  }
  if (fd_ >= 0) {
    (void)sys_.close(std::exchange(fd_, -1));
  }
}

V4l2Sys::Mapping VideoStream::release(std::uint32_t index) noexcept {
  return std::exchange(mappings_[index], V4l2Sys::Mapping{});
}

int VideoStream::call(unsigned long request, void* argument) noexcept {
  int result = -EINTR;
  for (int i = 0; i < kInterruptions && result == -EINTR; ++i) {
    result = sys_.ioctl(fd_, request, argument);
  }
  return result;
}

Result<> VideoStream::identify(std::string& problem) {
  v4l2_capability capability{};
  if (const int error = call(VIDIOC_QUERYCAP, &capability); error < 0) {
    return explain(error, "it does not answer", problem);
  }
  const bool per_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = per_node ? capability.device_caps : capability.capabilities;
  grant_.card = text_of(capability.card);
  grant_.bus_info = text_of(capability.bus_info);
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    problem = grant_.card +
              " does not capture into single-plane mapped buffers; name its depth "
              "node instead";
    return Errc::kUnsupported;
  }
  return {};
}

/// Drivers answer with what they have instead of refusing: everything that came back is compared.
Result<> VideoStream::set_format(const V4l2Config& config, std::string& problem) {
  v4l2_format format{};
  format.type = kCapture;
  if (const int error = call(VIDIOC_G_FMT, &format); error < 0) {
    return explain(error, "it does not tell its format", problem);
  }
  v4l2_pix_format& pixels = format.fmt.pix;
  pixels.pixelformat = config.fourcc;
  pixels.field = V4L2_FIELD_NONE;
  pixels.width = config.width == 0 ? pixels.width : config.width;
  pixels.height = config.height == 0 ? pixels.height : config.height;
  pixels.bytesperline = 0;
  pixels.sizeimage = 0;
  const v4l2_pix_format asked = pixels;
  if (const int error = call(VIDIOC_S_FMT, &format); error < 0) {
    return explain(error, "it refused the format " + name_of(config.fourcc), problem);
  }
  const bool same_size = pixels.width == asked.width && pixels.height == asked.height;
  if (pixels.pixelformat != asked.pixelformat || !same_size) {
    problem = "asked for " + name_of(asked.pixelformat) + " " + std::to_string(asked.width) + "x" +
              std::to_string(asked.height) + ", it gives " + name_of(pixels.pixelformat) + " " +
              std::to_string(pixels.width) + "x" + std::to_string(pixels.height) + " and offers " +
              offered_formats();
    return Errc::kUnsupported;
  }
  format_ = pixels;
  grant_.size_image = pixels.sizeimage;
  return {};
}

std::string VideoStream::offered_formats() noexcept {
  constexpr std::uint32_t kMost = 128;
  std::string offered;
  for (std::uint32_t i = 0; i < kMost; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = kCapture;
    if (call(VIDIOC_ENUM_FMT, &description) < 0) {
      break;
    }
    offered += (i == 0 ? "" : ", ") + name_of(description.pixelformat);
  }
  return offered.empty() ? "nothing else" : offered;
}

/// Optional in V4L2: what a driver cannot do leaves its own rate, which is then reported.
void VideoStream::set_frame_rate(const V4l2Config& config) noexcept {
  v4l2_streamparm parameters{};
  parameters.type = kCapture;
  v4l2_fract& period = parameters.parm.capture.timeperframe;
  int error = call(VIDIOC_G_PARM, &parameters);
  if (error >= 0 && config.frame_rate_hz > 0.0) {
    period.numerator = 1000;
    period.denominator = static_cast<std::uint32_t>(1000.0 * config.frame_rate_hz);
    error = call(VIDIOC_S_PARM, &parameters);
  }
  if (error >= 0 && period.numerator != 0) {
    grant_.frame_rate_hz = static_cast<double>(period.denominator) / period.numerator;
  }
}

Result<> VideoStream::map_buffers(const V4l2Config& config, std::string& problem) {
  constexpr std::uint32_t kFewest = 2;
  v4l2_requestbuffers request{};
  request.type = kCapture;
  request.memory = V4L2_MEMORY_MMAP;
  request.count = std::clamp(config.num_buffers, kFewest, SlotPool::kMaxSlots);
  if (const int error = call(VIDIOC_REQBUFS, &request); error < 0) {
    return explain(error, "it gave no buffers", problem);
  }
  if (request.count < kFewest) {
    problem = "it gave only " + std::to_string(request.count) + " buffers; two are needed";
    return Errc::kOutOfMemory;
  }
  grant_.num_buffers = std::min(request.count, SlotPool::kMaxSlots);
  for (std::uint32_t i = 0; i < grant_.num_buffers; ++i) {
    v4l2_buffer buffer{};
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = i;
    int error = call(VIDIOC_QUERYBUF, &buffer);
    if (error >= 0) {
      error = sys_.map(fd_, buffer.length, buffer.m.offset, mappings_[i]);
    }
    if (error < 0) {
      return explain(error, "buffer " + std::to_string(i) + " cannot be mapped", problem);
    }
  }
  return {};
}

int VideoStream::start() noexcept {
  int type = kCapture;
  return call(VIDIOC_STREAMON, &type);
}

int VideoStream::stop() noexcept {
  int type = kCapture;
  return call(VIDIOC_STREAMOFF, &type);
}

int VideoStream::queue(std::uint32_t index) noexcept {
  v4l2_buffer buffer{};
  buffer.type = kCapture;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return call(VIDIOC_QBUF, &buffer);
}

int VideoStream::dequeue(v4l2_buffer& buffer) noexcept {
  buffer = {};
  buffer.type = kCapture;
  buffer.memory = V4L2_MEMORY_MMAP;
  return call(VIDIOC_DQBUF, &buffer);
}

int VideoStream::wait(int timeout_ms) noexcept {
  const int events = sys_.poll(fd_, timeout_ms);
  return events == -EINTR ? 0 : events;
}

}  // namespace dseam::hal::v4l2
