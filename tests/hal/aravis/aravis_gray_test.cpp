// SPDX-License-Identifier: Apache-2.0
// Gray beside depth: two GenICam sources on one trigger, joined by the time of their exposure.
#include <gtest/gtest.h>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "dseam/hal/camera/paired_camera.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;
using test::FakeGigeCamera;

constexpr std::uint32_t kSide = 512;  // Of Aravis' own fake, which is the gray camera here.

std::unique_ptr<AravisCamera> open(const AravisConfig& config) {
  std::string problem;
  auto camera = AravisCamera::open(config, problem);
  EXPECT_TRUE(camera.ok()) << problem;
  return camera.ok() ? std::move(camera.value()) : nullptr;
}

std::unique_ptr<AravisCamera> open_gray() {
  AravisConfig config;
  config.id = "Fake_1";
  config.gray = true;
  return open(config);
}

std::unique_ptr<AravisCamera> open_depth() {
  AravisConfig config;
  config.id = FakeGigeCamera::serial();
  config.pixel_format = "Depth";
  config.packet_bytes = 8192;
  return open(config);
}

TEST(AravisGray, a_mono8_camera_delivers_its_image_as_gray_and_no_depth) {
  const auto camera = open_gray();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  const auto lease = camera->next(10s);

  ASSERT_TRUE(lease.ok());
  EXPECT_TRUE(camera->model().has_gray);
  EXPECT_TRUE(lease.value().frame().depth.empty());
  EXPECT_GE(lease.value().frame().gray.size(), std::size_t{kSide} * kSide);
}

TEST(AravisGray, a_camera_that_is_told_another_format_is_refused) {
  AravisConfig config;
  config.id = "Fake_1";
  config.gray = true;
  config.pixel_format = "Mono16";
  std::string problem;

  const auto camera = AravisCamera::open(config, problem);

  EXPECT_EQ(camera.ok() ? Errc::kIo : camera.error(), Errc::kUnsupported);
  EXPECT_NE(problem.find("Mono8"), std::string::npos) << problem;
}

TEST(AravisGray, joined_to_a_depth_camera_both_images_come_in_one_frame) {
  const FakeGigeCamera device({.width = kSide, .height = kSide, .frame_rate_hz = 25.0});
  const auto depth = open_depth();
  const auto gray = open_gray();
  ASSERT_TRUE(PairedCamera::check(*depth, *gray).ok());
  PairedCamera both(*depth, *gray, 40'000'000);
  ASSERT_TRUE(both.start(FrameMode::kEvery).ok());

  int joined = 0;
  for (int i = 0; i < 100 && joined < 5; ++i) {
    const auto lease = both.next(1s);
    if (lease.ok()) {
      ++joined;
      EXPECT_EQ(lease.value().frame().depth.size(), std::size_t{2} * kSide * kSide);
      EXPECT_GE(lease.value().frame().gray.size(), std::size_t{kSide} * kSide);
    }
  }

  EXPECT_EQ(joined, 5);
  EXPECT_TRUE(both.model().has_gray);
  both.stop();
}

TEST(AravisGray, images_of_different_sizes_are_not_joined) {
  const FakeGigeCamera device;
  const auto depth = open_depth();
  const auto gray = open_gray();

  EXPECT_FALSE(PairedCamera::check(*depth, *gray).ok());
}

}  // namespace
}  // namespace dseam::hal::aravis
