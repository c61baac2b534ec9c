// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <thread>

#include "vivid.hpp"

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;
using test::Vivid;

class VividCameraTest : public ::testing::Test {
 protected:
  std::unique_ptr<V4l2Camera> open() {
    auto camera = V4l2Camera::open(config_, linux_v4l2_sys(), problem_);
    EXPECT_TRUE(camera.ok()) << problem_;
    return camera.ok() ? std::move(camera.value()) : nullptr;
  }
  static int frames_in(DepthCamera& camera, int attempts) {
    int frames = 0;
    for (int i = 0; i < attempts; ++i) {
      frames += camera.next(500ms).ok() ? 1 : 0;
    }
    return frames;
  }
  /// Frames until the counter has risen; false when it never does.
  static bool until(DepthCamera& camera, std::uint64_t CameraHealth::*counter,
                    std::uint64_t value) {
    for (int i = 0; i < 2000 && camera.health().*counter < value; ++i) {
      (void)camera.next(20ms);
    }
    return camera.health().*counter >= value;
  }

  V4l2Config config_ = Vivid::config();
  std::string problem_;
};

TEST_F(VividCameraTest, z16_is_granted_as_another_format_and_refused_by_name) {
  config_.fourcc = depth::fourcc('Z', '1', '6', ' ');

  const auto camera = V4l2Camera::open(config_, linux_v4l2_sys(), problem_);

  ASSERT_FALSE(camera.ok());
  EXPECT_EQ(camera.error(), Errc::kUnsupported);
  EXPECT_NE(problem_.find("it gives YUYV"), std::string::npos) << problem_;
  EXPECT_NE(problem_.find("Y16 "), std::string::npos) << problem_;
}

TEST_F(VividCameraTest, a_device_that_another_streams_from_is_busy) {
  const auto owner = open();
  ASSERT_TRUE(owner->start(FrameMode::kEvery).ok());

  const auto second = V4l2Camera::open(config_, linux_v4l2_sys(), problem_);

  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error(), Errc::kUnavailable);
  EXPECT_NE(problem_.find("another program"), std::string::npos) << problem_;
}

TEST_F(VividCameraTest, a_frame_that_the_driver_flags_is_damaged_and_the_next_is_good) {
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  (void)camera->next(2s);

  ASSERT_TRUE(Vivid::set("Inject V4L2_BUF_FLAG_ERROR", 1));

  EXPECT_TRUE(until(*camera, &CameraHealth::damaged, 1));
  EXPECT_TRUE(camera->next(2s).ok());
  EXPECT_EQ(camera->health().reconnects, 0U);
}

TEST_F(VividCameraTest, dropped_frames_are_gaps_in_the_sequence) {
  const auto camera = open();
  ASSERT_TRUE(Vivid::set("Percentage of Dropped Buffers", 60));
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  EXPECT_TRUE(until(*camera, &CameraHealth::lost, 3));
  EXPECT_TRUE(Vivid::set("Percentage of Dropped Buffers", 0));
}

TEST_F(VividCameraTest, a_fatal_streaming_error_is_survived_by_opening_again) {
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  (void)camera->next(2s);

  ASSERT_TRUE(Vivid::set("Inject Fatal Streaming Error", 1));

  EXPECT_TRUE(until(*camera, &CameraHealth::reconnects, 1));
  EXPECT_GT(frames_in(*camera, 5), 0);
}

TEST_F(VividCameraTest, injected_call_errors_are_named_or_survived) {
  ASSERT_TRUE(Vivid::set("Inject VIDIOC_REQBUFS Error", 1));
  const auto refused = V4l2Camera::open(config_, linux_v4l2_sys(), problem_);
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(problem_.find("it gave no buffers"), std::string::npos) << problem_;

  const auto camera = open();
  ASSERT_TRUE(Vivid::set("Inject VIDIOC_STREAMON Error", 1));
  EXPECT_FALSE(camera->start(FrameMode::kEvery).ok());
  bool started = false;
  for (int i = 0; i < 50 && !started; ++i) {
    std::this_thread::sleep_for(100ms);
    started = camera->start(FrameMode::kEvery).ok();
  }
  EXPECT_TRUE(started);
  (void)camera->next(2s);
  ASSERT_TRUE(Vivid::set("Inject VIDIOC_QBUF Error", 1));
  EXPECT_GT(frames_in(*camera, 20), 10);
}

TEST_F(VividCameraTest, stamps_at_the_end_of_a_frame_are_not_taken_for_the_future) {
  for (const std::int32_t source : {0, 1}) {  // End of frame, start of exposure.
    ASSERT_TRUE(Vivid::set("Timestamp Source", source));
    const auto camera = open();
    ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
    for (int i = 0; i < 5; ++i) {
      const auto lease = camera->next(2s);
      ASSERT_TRUE(lease.ok());
      EXPECT_LE(lease.value().frame().captured_ns, lease.value().frame().dequeued_ns);
    }
  }
  EXPECT_TRUE(Vivid::set("Timestamp Source", 0));
}

TEST_F(VividCameraTest, a_sequence_that_wraps_loses_nothing) {
  ASSERT_TRUE(Vivid::set("Wrap Sequence Number", 1));
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  std::uint64_t before = 0;
  for (int i = 0; i < 200; ++i) {  // The driver starts 128 numbers before the wrap.
    const auto lease = camera->next(2s);
    ASSERT_TRUE(lease.ok());
    const DepthFrame& frame = lease.value().frame();
    ASSERT_TRUE(i == 0 || frame.sequence == before + 1 + frame.gap)
        << "frame " << i << ": " << before << " to " << frame.sequence << ", gap " << frame.gap
        << ", damaged " << camera->health().damaged << ", lost " << camera->health().lost;
    ASSERT_LT(frame.gap, 100U);
    before = frame.sequence;
  }
  EXPECT_TRUE(Vivid::set("Wrap Sequence Number", 0));
}

TEST_F(VividCameraTest, a_time_stamp_that_wraps_never_leaves_the_present) {
  for (const std::int32_t bits : {1, 2}) {  // Of 64 and of 32 bits.
    ASSERT_TRUE(Vivid::set("Wrap Timestamp", bits));
    const auto camera = open();
    ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
    std::int64_t before_ns = 0;
    for (int i = 0; i < 20; ++i) {
      const auto lease = camera->next(2s);
      ASSERT_TRUE(lease.ok());
      const DepthFrame& frame = lease.value().frame();
      EXPECT_LE(frame.captured_ns, frame.dequeued_ns);
      EXPECT_GE(frame.captured_ns, before_ns);
      before_ns = frame.captured_ns;
    }
  }
  EXPECT_TRUE(Vivid::set("Wrap Timestamp", 0));
}

TEST_F(VividCameraTest, stop_returns_within_100_ms_also_while_the_device_is_gone) {
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  (void)camera->next(2s);
  ASSERT_TRUE(Vivid::set("Disconnect", 1));

  const auto begin = std::chrono::steady_clock::now();
  camera->stop();

  EXPECT_LT(std::chrono::steady_clock::now() - begin, 100ms);
}

TEST_F(VividCameraTest, two_hundred_disconnects_leak_neither_descriptors_nor_mappings) {
  config_.first_retry = 5ms;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(camera->next(2s).ok());
  const std::size_t descriptors = test::open_descriptors();
  const std::size_t mappings = test::video_mappings();

  for (std::uint64_t n = 1; n <= 200; ++n) {
    ASSERT_TRUE(Vivid::set("Disconnect", 1));
    ASSERT_TRUE(until(*camera, &CameraHealth::reconnects, n)) << n;
  }

  EXPECT_GT(frames_in(*camera, 5), 0);
  EXPECT_EQ(test::open_descriptors(), descriptors);
  EXPECT_EQ(test::video_mappings(), mappings);
}

TEST_F(VividCameraTest, the_list_names_it_and_says_that_it_can_be_opened) {
  const auto cameras = list_cameras(linux_v4l2_sys());

  ASSERT_FALSE(cameras.empty());
  EXPECT_EQ(cameras[0].backend, "v4l2");
  EXPECT_EQ(cameras[0].model, "vivid");
  EXPECT_EQ(cameras[0].why_not, "");
}

}  // namespace
}  // namespace dseam::hal::v4l2
