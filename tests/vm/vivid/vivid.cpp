// SPDX-License-Identifier: Apache-2.0
#include "vivid.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <fstream>

namespace dseam::test {

bool Vivid::set(const std::string& name, std::int32_t value) {
  const int fd = open(kCapture, O_RDWR | O_NONBLOCK | O_CLOEXEC);
  v4l2_queryctrl control{};
  control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  bool done = false;
  while (!done && ioctl(fd, VIDIOC_QUERYCTRL, &control) == 0) {
    const std::string found(reinterpret_cast<const char*>(control.name));  // NOLINT: kernel's type
    if (found.find(name) != found.npos) {
      v4l2_control setting{.id = control.id, .value = value};
      done = ioctl(fd, VIDIOC_S_CTRL, &setting) == 0;
      break;
    }
    control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  close(fd);
  return done;
}

hal::v4l2::V4l2Config Vivid::config() {
  hal::v4l2::V4l2Config config;
  config.device = kCapture;
  config.fourcc = depth::fourcc('Y', '1', '6', ' ');
  config.width = 320;
  config.height = 180;
  config.frame_rate_hz = 30.0;
  config.model.intrinsics = {.fx = 512.0, .fy = 512.0, .cx = 159.5, .cy = 89.5};
  config.model.scale[2] = 1.0 / 64.0;
  config.lost_after = std::chrono::milliseconds(3000);  // An emulator may stand still for a while.
  return config;
}

std::size_t video_mappings() {
  std::ifstream maps("/proc/self/maps");
  std::size_t count = 0;
  for (std::string line; std::getline(maps, line);) {
    count += line.find("/dev/video") != line.npos ? 1U : 0U;
  }
  return count;
}

}  // namespace dseam::test
