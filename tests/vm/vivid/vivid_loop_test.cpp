// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/camera/paired_camera.hpp"
#include "vivid.hpp"
#include "vivid_output.hpp"

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;
using test::Vivid;
using test::VividOutput;

std::vector<std::byte> noise(std::size_t bytes, std::uint64_t seed) {
  std::vector<std::byte> image(bytes);
  Pcg32 random(seed);
  for (std::byte& byte : image) {
    byte = std::byte(random.below(256));
  }
  return image;
}

std::unique_ptr<V4l2Camera> open_node(const char* device, bool gray) {
  V4l2Config config = Vivid::config();
  config.device = device;
  config.gray = gray;
  config.fourcc = gray ? depth::fourcc('G', 'R', 'E', 'Y') : config.fourcc;
  config.width = VividOutput::kWidth;
  config.height = VividOutput::kHeight;
  config.frame_rate_hz = 0.0;
  std::string problem;
  auto camera = V4l2Camera::open(config, linux_v4l2_sys(), problem);
  EXPECT_TRUE(camera.ok()) << problem;
  return camera.ok() ? std::move(camera.value()) : nullptr;
}

bool same(std::span<const std::byte> a, std::span<const std::byte> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size()) == 0;
}

// Images of ours, out through one end of the driver and in through the other: the depth through one
// camera and the gray through another.
TEST(VividLoop, depth_and_gray_come_through_the_kernel_with_every_bit) {
  const auto depth = noise(std::size_t{VividOutput::kWidth} * VividOutput::kHeight * 2, 7);
  const auto gray = noise(std::size_t{VividOutput::kWidth} * VividOutput::kHeight, 8);
  const VividOutput depth_out(0, depth::fourcc('Y', '1', '6', ' '), depth);
  const VividOutput gray_out(2, depth::fourcc('G', 'R', 'E', 'Y'), gray);
  ASSERT_TRUE(depth_out.ok());
  ASSERT_TRUE(gray_out.ok());
  const auto depth_camera = open_node("/dev/video0", false);
  const auto gray_camera = open_node("/dev/video2", true);
  ASSERT_TRUE(PairedCamera::check(*depth_camera, *gray_camera).ok());
  PairedCamera camera(*depth_camera, *gray_camera, 50'000'000);
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());

  int whole = 0;
  for (int i = 0; i < 100 && whole < 5; ++i) {
    const auto lease = camera.next(1s);
    if (lease.ok()) {
      const DepthFrame& frame = lease.value().frame();
      whole += same(frame.depth, depth) && same(frame.gray, gray) ? 1 : 0;
    }
  }
  camera.stop();

  EXPECT_TRUE(depth_out.ok());
  EXPECT_TRUE(gray_out.ok());
  EXPECT_EQ(whole, 5);
}

}  // namespace
}  // namespace dseam::hal::v4l2
