// SPDX-License-Identifier: Apache-2.0
// Depth and gray of one camera in one frame: GigE Vision's multipart payload over the loopback.
#include <gtest/gtest.h>

#include <algorithm>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"
#include "hal/aravis/fake/multipart_sender.hpp"

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;
using test::FakeGigeCamera;
using test::MultipartSender;
using test::SentPart;

constexpr std::uint32_t kWidth = 64;
constexpr std::uint32_t kHeight = 48;
constexpr std::uint8_t kDepthByte = 0xD3;
constexpr std::uint8_t kGrayByte = 0x47;
constexpr std::uint32_t kConfidence8 = 0x010800C6;  // PFNC; Aravis has no name for it.

SentPart depth_part() {
  return {.type = ARV_BUFFER_PART_DATA_TYPE_3D_IMAGE,
          .pixel_format = ARV_PIXEL_FORMAT_COORD3D_C_16,
          .width = kWidth,
          .height = kHeight,
          .bytes = std::vector<std::uint8_t>(2 * kWidth * kHeight, kDepthByte)};
}

SentPart gray_part() {
  return {.width = kWidth,
          .height = kHeight,
          .bytes = std::vector<std::uint8_t>(kWidth * kHeight, kGrayByte)};
}

AravisConfig both_images() {
  AravisConfig config;
  config.id = FakeGigeCamera::serial();
  config.pixel_format = "Depth";
  config.packet_bytes = 1500;
  config.gray_beside_depth = true;
  return config;
}

class AravisMultipart : public ::testing::Test {
 protected:
  static constexpr int kTries = 10;

  AravisMultipart() {
    std::string problem;
    auto opened = AravisCamera::open(both_images(), problem);
    EXPECT_TRUE(opened.ok()) << problem;
    camera_ = std::move(opened.value());
    EXPECT_TRUE(camera_->start(FrameMode::kEvery).ok());
  }
  /// Sends such frames until one is delivered.
  Result<FrameLease> exchange(const std::vector<SentPart>& parts) {
    Result<FrameLease> lease = Errc::kTimeout;
    for (int i = 0; i < kTries && !lease.ok(); ++i) {
      sender_.send(parts);
      lease = camera_->next(50ms);
    }
    return lease;
  }
  void expect_damaged(const std::vector<SentPart>& parts) {
    const std::uint64_t before = camera_->health().damaged;
    EXPECT_FALSE(exchange(parts).ok());
    EXPECT_GT(camera_->health().damaged, before);
  }

  FakeGigeCamera device_{{.width = kWidth, .height = kHeight, .multipart = true}};
  std::unique_ptr<AravisCamera> camera_;
  MultipartSender sender_{device_.fake()};
};

TEST_F(AravisMultipart, both_images_of_one_camera_come_in_one_frame) {
  const auto lease = exchange({depth_part(), gray_part()});

  ASSERT_TRUE(lease.ok());
  const DepthFrame& frame = lease.value().frame();
  EXPECT_TRUE(camera_->model().has_gray);
  ASSERT_EQ(frame.depth.size(), 2U * kWidth * kHeight);
  ASSERT_EQ(frame.gray.size(), std::size_t{kWidth} * kHeight);
  const auto is = [](std::uint8_t value) {
    return [value](std::byte byte) { return byte == std::byte{value}; };
  };
  EXPECT_TRUE(std::ranges::all_of(frame.depth, is(kDepthByte)));
  EXPECT_TRUE(std::ranges::all_of(frame.gray, is(kGrayByte)));
}

TEST_F(AravisMultipart, the_images_are_known_by_their_format_in_any_order_beside_others) {
  SentPart confidence = gray_part();
  confidence.type = ARV_BUFFER_PART_DATA_TYPE_CONFIDENCE_MAP;
  confidence.pixel_format = kConfidence8;

  const auto lease = exchange({confidence, gray_part(), depth_part()});

  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(lease.value().frame().depth.front(), std::byte{kDepthByte});
  EXPECT_EQ(lease.value().frame().gray.back(), std::byte{kGrayByte});
}

TEST_F(AravisMultipart, a_frame_without_one_of_its_images_is_damaged) {
  expect_damaged({depth_part()});
  expect_damaged({gray_part(), gray_part()});
}

TEST_F(AravisMultipart, an_image_of_another_size_is_damaged) {
  SentPart low = gray_part();
  low.height = kHeight / 2;

  expect_damaged({depth_part(), low});
}

TEST_F(AravisMultipart, rows_with_padding_that_was_not_agreed_are_damaged) {
  SentPart padded = depth_part();
  padded.row_padding_bytes = 4;

  expect_damaged({padded, gray_part()});
}

TEST_F(AravisMultipart, an_image_that_is_shorter_than_its_size_promises_is_damaged) {
  SentPart shortened = depth_part();
  shortened.bytes.resize(shortened.bytes.size() - 2);

  expect_damaged({shortened, gray_part()});
}

TEST(AravisMultipartOpen, each_component_is_asked_for_in_its_own_format) {
  const FakeGigeCamera device({.width = kWidth, .height = kHeight, .multipart = true});
  std::string problem;

  const auto camera = AravisCamera::open(both_images(), problem);

  ASSERT_TRUE(camera.ok()) << problem;
  EXPECT_EQ(device.component_format(0), ARV_PIXEL_FORMAT_MONO_8);
  EXPECT_EQ(device.component_format(1), ARV_PIXEL_FORMAT_COORD3D_C_16);
}

TEST(AravisMultipartOpen, a_camera_that_sends_only_depth_is_refused_with_the_cure) {
  const FakeGigeCamera device;
  std::string problem;

  const auto camera = AravisCamera::open(both_images(), problem);

  EXPECT_EQ(camera.ok() ? Errc::kIo : camera.error(), Errc::kUnsupported);
  EXPECT_NE(problem.find("camera.gray_device"), std::string::npos) << problem;
}

}  // namespace
}  // namespace dseam::hal::aravis
