// SPDX-License-Identifier: Apache-2.0
#include "vivid_output.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

namespace dseam::test {
namespace {

int opened(int node) {
  return open(("/dev/video" + std::to_string(node)).c_str(), O_RDWR | O_CLOEXEC);
}

/// 1280 x 720 at 60 Hz as HDMI defines it; the driver needs it named on both sides.
v4l2_dv_timings hdmi_timings(int fd) {
  for (std::uint32_t i = 0; i < 256; ++i) {
    v4l2_enum_dv_timings entry{};
    entry.index = i;
    if (ioctl(fd, VIDIOC_ENUM_DV_TIMINGS, &entry) != 0) {
      break;
    }
    const v4l2_bt_timings& bt = entry.timings.bt;
    if (bt.width == VividOutput::kWidth && bt.height == VividOutput::kHeight &&
        bt.pixelclock == 74'250'000) {
      return entry.timings;
    }
  }
  return {};
}

bool join_both_ends(int capture, int output, std::uint32_t fourcc, std::size_t size) {
  int hdmi_input = 3;
  int hdmi_output = 1;
  bool ok = ioctl(capture, VIDIOC_S_INPUT, &hdmi_input) == 0;
  ok = ioctl(output, VIDIOC_S_OUTPUT, &hdmi_output) == 0 && ok;
  v4l2_dv_timings timings = hdmi_timings(output);
  ok = ioctl(output, VIDIOC_S_DV_TIMINGS, &timings) == 0 && ok;
  ok = ioctl(capture, VIDIOC_S_DV_TIMINGS, &timings) == 0 && ok;
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  ok = ioctl(output, VIDIOC_G_FMT, &format) == 0 && ok;
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.width = VividOutput::kWidth;
  format.fmt.pix.height = VividOutput::kHeight;
  format.fmt.pix.bytesperline = 0;  // Else it stays that of the format before.
  format.fmt.pix.sizeimage = 0;
  ok = ioctl(output, VIDIOC_S_FMT, &format) == 0 && ok;
  return ok && format.fmt.pix.pixelformat == fourcc && format.fmt.pix.sizeimage == size;
}

/// Sets a control of the capture node by a part of its name.
bool set_control(int fd, const std::string& name, std::int32_t value) {
  v4l2_queryctrl control{};
  control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (ioctl(fd, VIDIOC_QUERYCTRL, &control) == 0) {
    const std::string found(reinterpret_cast<const char*>(control.name));  // NOLINT: kernel's type
    if (found.find(name) != found.npos) {
      v4l2_control setting{.id = control.id, .value = value};
      return ioctl(fd, VIDIOC_S_CTRL, &setting) == 0;
    }
    control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  return false;
}

v4l2_buffer empty_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

VividOutput::VividOutput(int first, std::uint32_t fourcc, std::span<const std::byte> image)
    : fd_(opened(first + 1)), size_(image.size()), image_(image.data()) {
  const int capture = opened(first);
  ok_ = join_both_ends(capture, fd_, fourcc, size_) && set_control(capture, "OSD Text Mode", 2) &&
        set_control(capture, "Loop Video", 1);
  close(capture);
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  request.memory = V4L2_MEMORY_MMAP;
  ok_ = ok_ && ioctl(fd_, VIDIOC_REQBUFS, &request) == 0;
  for (std::uint32_t i = 0; ok_ && i < kBuffers; ++i) {
    ok_ = map(i) && queue(i);
  }
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  ok_ = ok_ && ioctl(fd_, VIDIOC_STREAMON, &type) == 0;
  thread_ = std::thread([this] { play(); });
}

VividOutput::~VividOutput() {
  done_ = true;
  thread_.join();
  close(fd_);
}

bool VividOutput::map(std::uint32_t index) {
  v4l2_buffer buffer = empty_buffer(index);
  if (ioctl(fd_, VIDIOC_QUERYBUF, &buffer) != 0 || buffer.length < size_) {
    return false;
  }
  void* place = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_,
                     static_cast<off_t>(buffer.m.offset));
  places_[index] = static_cast<std::byte*>(place);
  return place != MAP_FAILED;
}

bool VividOutput::queue(std::uint32_t index) {
  const std::byte* image = image_;
  if (shown_[index] != image) {
    std::memcpy(places_[index], image, size_);
    shown_[index] = image;
  }
  v4l2_buffer buffer = empty_buffer(index);
  buffer.bytesused = static_cast<std::uint32_t>(size_);
  buffer.field = V4L2_FIELD_NONE;
  return ioctl(fd_, VIDIOC_QBUF, &buffer) == 0;
}

void VividOutput::play() {
  while (!done_ && ok_) {
    v4l2_buffer buffer = empty_buffer(0);
    ok_ = ioctl(fd_, VIDIOC_DQBUF, &buffer) == 0 && queue(buffer.index);
  }
}

}  // namespace dseam::test
