// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <span>
#include <thread>
#include <vector>

#include "dseam/base/random.hpp"
#include "vivid.hpp"

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;
using test::Vivid;

constexpr std::uint32_t kWidth = 1280;
constexpr std::uint32_t kHeight = 720;
constexpr std::uint32_t kY16 = depth::fourcc('Y', '1', '6', ' ');

int opened(const char* node) { return open(node, O_RDWR | O_CLOEXEC); }

/// 1280 x 720 at 60 Hz as HDMI defines it; the driver needs it named on both sides.
v4l2_dv_timings hdmi_timings(int fd) {
  for (std::uint32_t i = 0; i < 256; ++i) {
    v4l2_enum_dv_timings entry{};
    entry.index = i;
    if (ioctl(fd, VIDIOC_ENUM_DV_TIMINGS, &entry) != 0) {
      break;
    }
    const v4l2_bt_timings& bt = entry.timings.bt;
    if (bt.width == kWidth && bt.height == kHeight && bt.pixelclock == 74'250'000) {
      return entry.timings;
    }
  }
  return {};
}

bool join_both_ends(int capture, int output) {
  constexpr int kHdmiInput = 3;
  constexpr int kHdmiOutput = 1;
  int input = kHdmiInput;
  int out = kHdmiOutput;
  bool ok = ioctl(capture, VIDIOC_S_INPUT, &input) == 0;
  ok = ioctl(output, VIDIOC_S_OUTPUT, &out) == 0 && ok;
  v4l2_dv_timings timings = hdmi_timings(output);
  ok = ioctl(output, VIDIOC_S_DV_TIMINGS, &timings) == 0 && ok;
  ok = ioctl(capture, VIDIOC_S_DV_TIMINGS, &timings) == 0 && ok;
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  ok = ioctl(output, VIDIOC_G_FMT, &format) == 0 && ok;
  format.fmt.pix.pixelformat = kY16;
  format.fmt.pix.width = kWidth;
  format.fmt.pix.height = kHeight;
  ok = ioctl(output, VIDIOC_S_FMT, &format) == 0 && ok;
  return ok && format.fmt.pix.pixelformat == kY16 &&
         format.fmt.pix.sizeimage == kWidth * kHeight * 2;
}

/// Plays one image again and again through the driver's video output.
class Player {
 public:
  Player(int fd, std::span<const std::byte> image) : fd_(fd) {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    request.memory = V4L2_MEMORY_MMAP;
    ok_ = ioctl(fd_, VIDIOC_REQBUFS, &request) == 0;
    for (std::uint32_t i = 0; ok_ && i < kBuffers; ++i) {
      v4l2_buffer buffer = empty(i);
      ok_ = ioctl(fd_, VIDIOC_QUERYBUF, &buffer) == 0 && buffer.length >= image.size();
      void* place = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_,
                         static_cast<off_t>(buffer.m.offset));
      ok_ = ok_ && place != MAP_FAILED;
      if (ok_) {
        std::memcpy(place, image.data(), image.size());
        ok_ = queue(i, image.size());
      }
    }
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    ok_ = ok_ && ioctl(fd_, VIDIOC_STREAMON, &type) == 0;
    thread_ = std::thread([this, size = image.size()] { play(size); });
  }
  ~Player() {
    done_ = true;
    thread_.join();
    close(fd_);
  }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  static constexpr std::uint32_t kBuffers = 4;

  static v4l2_buffer empty(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
  }
  bool queue(std::uint32_t index, std::size_t size) {
    v4l2_buffer buffer = empty(index);
    buffer.bytesused = static_cast<std::uint32_t>(size);
    buffer.field = V4L2_FIELD_NONE;
    return ioctl(fd_, VIDIOC_QBUF, &buffer) == 0;
  }
  void play(std::size_t size) {
    while (!done_ && ok_) {
      v4l2_buffer buffer = empty(0);
      ok_ = ioctl(fd_, VIDIOC_DQBUF, &buffer) == 0 && queue(buffer.index, size);
    }
  }

  int fd_;
  std::atomic<bool> ok_{false};
  std::atomic<bool> done_{false};
  std::thread thread_;
};

// A depth image of ours, out through one end of the driver and in through the other.
TEST(VividLoop, a_depth_image_comes_through_the_kernel_with_every_bit) {
  const int capture = opened(Vivid::kCapture);
  const int output = opened("/dev/video1");
  ASSERT_TRUE(join_both_ends(capture, output));
  close(capture);
  ASSERT_TRUE(Vivid::set("OSD Text Mode", 2));
  ASSERT_TRUE(Vivid::set("Loop Video", 1));
  std::vector<std::byte> image(kWidth * kHeight * 2);
  Pcg32 random(7);
  for (std::byte& byte : image) {
    byte = std::byte(random.below(256));
  }
  const Player player(output, image);
  ASSERT_TRUE(player.ok());
  V4l2Config config = Vivid::config();
  config.width = kWidth;
  config.height = kHeight;
  config.frame_rate_hz = 0.0;
  std::string problem;
  auto camera = V4l2Camera::open(config, linux_v4l2_sys(), problem);
  ASSERT_TRUE(camera.ok()) << problem;
  ASSERT_TRUE(camera.value()->start(FrameMode::kEvery).ok());

  int same = 0;
  for (int i = 0; i < 60 && same < 5; ++i) {
    const auto lease = camera.value()->next(1s);
    ASSERT_TRUE(lease.ok()) << name(lease.error());
    const auto bytes = lease.value().frame().depth;
    ASSERT_EQ(bytes.size(), image.size());
    same += std::memcmp(bytes.data(), image.data(), image.size()) == 0 ? 1 : 0;
  }

  EXPECT_TRUE(player.ok());
  EXPECT_EQ(same, 5);
}

}  // namespace
}  // namespace dseam::hal::v4l2
