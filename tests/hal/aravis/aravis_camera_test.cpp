// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <span>
#include <thread>

#include "hal/aravis/aravis_camera_fixture.hpp"

namespace dseam::hal::aravis {
namespace {

/// Whether one of the notes has these words; in which order they come is open.
bool says(const AravisGrant& grant, const char* words) {
  return std::ranges::any_of(
      grant.notes, [&](const std::string& note) { return note.find(words) != note.npos; });
}

/// What FakeGigeCamera fills its frames with, whatever the frame's number.
bool has_the_pattern(std::span<const std::byte> bytes) {
  const auto first = std::to_integer<unsigned>(bytes[1]);
  bool right = true;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    right = right && bytes[i] == std::byte{7} && bytes[i + 1] == std::byte((first + i / 2) % 256U);
  }
  return right;
}

TEST_F(AravisCameraTest, the_model_is_read_axis_by_axis_from_the_device) {
  const FakeGigeCamera device;

  const auto camera = open();

  const depth::DepthModel& model = camera->model();
  EXPECT_EQ(model.format, depth::SampleFormat::kC16);
  EXPECT_EQ(model.geometry, depth::Geometry::kProjected);
  EXPECT_EQ(model.intrinsics.width, 320U);
  EXPECT_DOUBLE_EQ(model.intrinsics.fx, 512.0);
  EXPECT_DOUBLE_EQ(model.intrinsics.cx, 159.5);
  EXPECT_DOUBLE_EQ(model.scale[0], 0.1);
  EXPECT_DOUBLE_EQ(model.offset[1], -10.0);
  EXPECT_DOUBLE_EQ(model.scale[2], 0.05);
  EXPECT_DOUBLE_EQ(model.offset[2], 100.0);
  EXPECT_TRUE(model.has_invalid_value);
}

TEST_F(AravisCameraTest, a_calibrated_float_cloud_in_metres_is_understood) {
  const FakeGigeCamera device({.pixel_format = ARV_PIXEL_FORMAT_COORD3D_ABC_32F,
                               .output_mode = "CalibratedABC_Grid",
                               .distance_unit = "Meter"});

  const auto camera = open();

  EXPECT_EQ(camera->model().format, depth::SampleFormat::kABC32f);
  EXPECT_EQ(camera->model().geometry, depth::Geometry::kCalibrated);
  EXPECT_DOUBLE_EQ(camera->model().mm_per_unit, 1000.0);
}

TEST_F(AravisCameraTest, a_number_that_is_described_as_an_integer_is_read_too) {
  const FakeGigeCamera device({.whole_focal_length = true});

  EXPECT_DOUBLE_EQ(open()->model().intrinsics.fx, 512.0);
}

TEST_F(AravisCameraTest, every_byte_arrives_in_the_camera_s_own_buffers) {
  const FakeGigeCamera device;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  std::set<const std::byte*> places;
  for (int n = 0; n < 30; ++n) {
    const auto lease = camera->next(10s);  // A busy computer loses packets, and so whole frames.
    ASSERT_TRUE(lease.ok());
    const auto bytes = lease.value().frame().depth;
    places.insert(bytes.data());
    ASSERT_EQ(bytes.size(), 320U * 240U * 2U);
    ASSERT_TRUE(has_the_pattern(bytes));
  }

  EXPECT_LE(places.size(), config_.num_buffers);  // Never copied: the buffers that were lent.
}

TEST_F(AravisCameraTest, a_camera_that_is_not_there_is_named_with_what_is) {
  const FakeGigeCamera device;
  config_.id = "NOT-THERE";

  EXPECT_EQ(refusal(), Errc::kNotFound);

  EXPECT_NE(problem_.find("NOT-THERE"), std::string::npos);
  EXPECT_NE(problem_.find(FakeGigeCamera::serial()), std::string::npos) << problem_;
}

TEST_F(AravisCameraTest, a_format_that_it_has_not_or_that_is_no_depth_is_refused) {
  const FakeGigeCamera device;

  config_.pixel_format = "Coord3D_ABC16";
  EXPECT_EQ(refusal(), Errc::kUnsupported);
  EXPECT_NE(problem_.find("Coord3D_ABC16"), std::string::npos) << problem_;

  config_.pixel_format = "Mono8";
  EXPECT_EQ(refusal(), Errc::kUnsupported);
  EXPECT_NE(problem_.find("no depth format"), std::string::npos) << problem_;
}

TEST_F(AravisCameraTest, without_a_3d_description_it_asks_for_one) {
  const FakeGigeCamera device({.described = false});

  EXPECT_EQ(refusal(), Errc::kUnsupported);
  EXPECT_NE(problem_.find("Scan3d"), std::string::npos) << problem_;

  config_.assumed_model = depth::DepthModel{.intrinsics = {.fx = 500.0, .fy = 500.0}};
  EXPECT_EQ(open()->model().intrinsics.width, 320U);
}

TEST_F(AravisCameraTest, a_description_that_cannot_be_decoded_is_refused) {
  const FakeGigeCamera device({.focal_length_px = 0.0});

  EXPECT_EQ(refusal(), Errc::kUnsupported);
  EXPECT_NE(problem_.find("focal length"), std::string::npos) << problem_;
}

TEST_F(AravisCameraTest, a_camera_in_use_is_said_to_be_in_use) {
  const FakeGigeCamera device;
  const auto owner = open();

  EXPECT_EQ(refusal(), Errc::kUnavailable);
  EXPECT_NE(problem_.find("another program"), std::string::npos) << problem_;
}

TEST_F(AravisCameraTest, frames_with_lost_packets_are_counted_and_never_delivered) {
  const FakeGigeCamera device({}, 0.01);
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  for (int i = 0; i < 40; ++i) {
    const auto lease = camera->next(50ms);
    if (lease.ok()) {
      const auto bytes = lease.value().frame().depth;
      ASSERT_EQ(bytes.back(),
                std::byte(std::to_integer<unsigned>(bytes[1]) + bytes.size() / 2 - 1));
    }
  }

  EXPECT_GT(camera->health().damaged, 0U);
}

TEST_F(AravisCameraTest, a_frame_of_another_size_mid_stream_is_damaged) {
  FakeGigeCamera device;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));

  device.write_register(ARV_FAKE_CAMERA_REGISTER_HEIGHT, 200);
  for (int i = 0; i < 20; ++i) {
    const auto lease = camera->next(30ms);
    ASSERT_TRUE(!lease.ok() || lease.value().frame().depth.size() == 320U * 240U * 2U);
  }

  EXPECT_GT(camera->health().damaged, 0U);
}

TEST_F(AravisCameraTest, the_socket_buffer_is_read_back_and_too_small_a_one_is_noted) {
  const FakeGigeCamera device;
  config_.socket_buffer_bytes = std::size_t{1} << 30U;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));
  std::this_thread::sleep_for(100ms);

  const AravisGrant grant = camera->grant();

  EXPECT_GT(grant.socket_buffer_bytes, 0U);
  EXPECT_TRUE(says(grant, "net.core.rmem_max"));
}

TEST_F(AravisCameraTest, the_packet_size_is_negotiated_and_proven_by_a_frame) {
  const FakeGigeCamera device;
  config_.packet_bytes = 0;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  EXPECT_TRUE(wait_for_frame(*camera));
  EXPECT_GE(camera->grant().packet_bytes, 1400U);
}

TEST_F(AravisCameraTest, where_large_packets_vanish_it_falls_back_to_1400_bytes) {
  const FakeGigeCamera device({.width = 160, .height = 120});  // A few dozen packets a frame.
  config_.first_frame = 300ms;
  const auto camera = open();
  ASSERT_EQ(camera->grant().packet_bytes, 8192U);
  test::narrow_the_path(true);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  const bool came = wait_for_frame(*camera);
  test::narrow_the_path(false);

  EXPECT_TRUE(came);
  EXPECT_EQ(camera->grant().packet_bytes, 1400U);
  EXPECT_TRUE(says(camera->grant(), "MTU"));
}

TEST_F(AravisCameraTest, the_list_has_the_camera_and_why_it_cannot_be_opened) {
  const FakeGigeCamera device;
  const auto owner = open();

  const auto cameras = list_cameras();

  const auto found = std::find_if(cameras.begin(), cameras.end(), [](const CameraInfo& camera) {
    return camera.id.find(FakeGigeCamera::serial()) != camera.id.npos;
  });
  ASSERT_NE(found, cameras.end());
  EXPECT_EQ(found->backend, "aravis");
  EXPECT_NE(found->why_not.find("another program"), std::string::npos) << found->why_not;
}

}  // namespace
}  // namespace dseam::hal::aravis
