// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/v4l2/v4l2_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <thread>

#include "dseam/hal/camera/camera_monitor.hpp"
#include "hal/v4l2/fake_v4l2_sys.hpp"

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;
using fake::DeviceFault;
using fake::FaultStep;
using test::FakeV4l2Sys;

class V4l2CameraTest : public ::testing::Test {
 protected:
  V4l2CameraTest() {
    config_.device = "/dev/video0";
    config_.model.intrinsics = {.fx = 50.0, .fy = 50.0, .cx = 15.5, .cy = 11.5};
    config_.first_retry = 2ms;
    config_.lost_after = 100ms;
  }
  std::unique_ptr<V4l2Camera> open(FakeV4l2Sys& sys) {
    auto camera = V4l2Camera::open(config_, sys, problem_);
    EXPECT_TRUE(camera.ok()) << problem_;
    return camera.ok() ? std::move(camera.value()) : nullptr;
  }
  Errc refusal(FakeV4l2Sys& sys) {
    const auto camera = V4l2Camera::open(config_, sys, problem_);
    EXPECT_FALSE(camera.ok());
    return camera.ok() ? Errc::kIo : camera.error();
  }
  /// Takes frames and has each judged as a consumer does.
  int frames_in(DepthCamera& camera, int attempts) {
    int frames = 0;
    for (int i = 0; i < attempts; ++i) {
      const auto lease = camera.next(10ms);
      const std::int64_t now_ns = std::chrono::steady_clock::now().time_since_epoch().count();
      frames += lease.ok() ? 1 : 0;
      (void)(lease.ok() ? monitor_.on_frame(lease.value().frame(), now_ns)
                        : monitor_.on_absence(lease.error(), now_ns));
    }
    return frames;
  }

  V4l2Config config_;
  std::string problem_;
  CameraMonitor monitor_{{}};
};

TEST_F(V4l2CameraTest, a_driver_that_answers_with_another_format_is_refused) {
  FakeV4l2Sys::Setup setup;
  setup.formats = {depth::fourcc('Y', 'U', 'Y', 'V'), depth::fourcc('G', 'R', 'E', 'Y')};
  FakeV4l2Sys sys(setup);

  EXPECT_EQ(refusal(sys), Errc::kUnsupported);
  EXPECT_NE(problem_.find("asked for Z16"), std::string::npos) << problem_;
  EXPECT_NE(problem_.find("YUYV, GREY"), std::string::npos) << problem_;
  EXPECT_EQ(sys.num_open() + sys.num_mapped(), 0U);
}

TEST_F(V4l2CameraTest, a_gray_node_delivers_gray_and_no_depth) {
  FakeV4l2Sys::Setup setup;
  setup.formats = {depth::fourcc('G', 'R', 'E', 'Y')};
  FakeV4l2Sys sys(setup);
  config_.gray = true;
  config_.fourcc = depth::fourcc('G', 'R', 'E', 'Y');
  const auto camera = open(sys);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  const auto lease = camera->next(1s);

  ASSERT_TRUE(lease.ok());
  EXPECT_TRUE(camera->model().has_gray);
  EXPECT_GE(lease.value().frame().gray.size(), depth::gray_bytes(camera->model()));
  EXPECT_TRUE(lease.value().frame().depth.empty());
}

TEST_F(V4l2CameraTest, a_depth_node_is_refused_as_a_gray_one) {
  FakeV4l2Sys sys;
  config_.gray = true;

  EXPECT_EQ(refusal(sys), Errc::kUnsupported);
  EXPECT_NE(problem_.find("not gray"), std::string::npos) << problem_;
}

TEST_F(V4l2CameraTest, another_size_than_asked_for_is_refused) {
  FakeV4l2Sys sys;
  config_.width = 640;
  config_.height = 480;

  EXPECT_EQ(refusal(sys), Errc::kUnsupported);
  EXPECT_NE(problem_.find("32x24"), std::string::npos) << problem_;
}

TEST_F(V4l2CameraTest, the_stride_that_the_driver_grants_is_in_the_model) {
  FakeV4l2Sys::Setup setup;
  setup.padding_bytes = 16;
  FakeV4l2Sys sys(setup);

  const auto camera = open(sys);

  EXPECT_EQ(camera->model().row_stride_bytes, 2U * 32U + 16U);
  EXPECT_EQ(camera->model().intrinsics.width, 32U);
}

TEST_F(V4l2CameraTest, every_reason_not_to_open_is_named_with_its_cure) {
  struct Row {
    int error;
    Errc code;
    const char* cure;
  };
  for (const Row& row :
       {Row{ENOENT, Errc::kNotFound, "by-id"}, Row{ENODEV, Errc::kNotFound, "dmesg"},
        Row{EACCES, Errc::kUnavailable, "group video"},
        Row{EBUSY, Errc::kUnavailable, "another program"}, Row{ENOMEM, Errc::kOutOfMemory, "fewer"},
        Row{EIO, Errc::kIo, ""}}) {
    FakeV4l2Sys sys;
    sys.fail_call(0, row.error, false);

    EXPECT_EQ(refusal(sys), row.code);
    EXPECT_NE(problem_.find(row.cure), std::string::npos) << problem_;
  }
}

TEST_F(V4l2CameraTest, a_node_that_does_not_capture_is_refused) {
  FakeV4l2Sys::Setup setup;
  setup.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  FakeV4l2Sys sys(setup);

  EXPECT_EQ(refusal(sys), Errc::kUnsupported);
  EXPECT_NE(problem_.find("depth node"), std::string::npos) << problem_;
}

TEST_F(V4l2CameraTest, fewer_buffers_than_asked_for_will_do_but_one_will_not) {
  FakeV4l2Sys::Setup setup;
  setup.most_buffers = 3;
  FakeV4l2Sys three(setup);
  EXPECT_EQ(open(three)->grant().num_buffers, 3U);

  setup.most_buffers = 1;
  FakeV4l2Sys one(setup);
  EXPECT_EQ(refusal(one), Errc::kOutOfMemory);
}

/// A fault of the vocabulary, and the camera's counter or the consumer's verdict that it ends in.
struct FaultCase {
  const char* name;
  DeviceFault fault;
  std::uint64_t CameraHealth::*counter;
  std::uint64_t at_least;
  CameraVerdict verdict = CameraVerdict::kGood;
};

class V4l2Fault : public V4l2CameraTest, public ::testing::WithParamInterface<FaultCase> {};

TEST_P(V4l2Fault, ends_in_its_counter_or_verdict_and_good_frames_follow) {
  FakeV4l2Sys sys;
  const auto camera = open(sys);
  const std::array<FaultStep, 3> script{
      {{DeviceFault::kNone, 5}, {GetParam().fault, 5}, {DeviceFault::kNone, 5}}};
  sys.play(script);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  const int frames = frames_in(*camera, 40);

  EXPECT_GE(frames, 8);
  EXPECT_GE(camera->health().*GetParam().counter, GetParam().at_least);
  EXPECT_GE(monitor_.counted(GetParam().verdict), 1U);
  EXPECT_TRUE(sys.script_done());
}

INSTANTIATE_TEST_SUITE_P(
    Vocabulary, V4l2Fault,
    ::testing::Values(FaultCase{"off", DeviceFault::kOff, &CameraHealth::lost, 5},
                      FaultCase{"stuck", DeviceFault::kStuck, &CameraHealth::delivered, 15,
                                CameraVerdict::kStuck},
                      FaultCase{"garbage", DeviceFault::kGarbage, &CameraHealth::damaged, 5},
                      FaultCase{"wrong", DeviceFault::kWrong, &CameraHealth::damaged, 5},
                      FaultCase{"intermittent", DeviceFault::kIntermittent, &CameraHealth::lost, 2},
                      FaultCase{"lost", DeviceFault::kLost, &CameraHealth::lost, 5},
                      FaultCase{"truncated", DeviceFault::kTruncated, &CameraHealth::damaged, 5},
                      FaultCase{"unplugged", DeviceFault::kUnplugged, &CameraHealth::reconnects, 1},
                      FaultCase{"clock_jump", DeviceFault::kClockJump, &CameraHealth::delivered, 15,
                                CameraVerdict::kClockJump}),
    [](const auto& row) { return std::string(row.param.name); });

TEST_F(V4l2CameraTest, frames_that_come_half_a_second_late_are_stale) {
  FakeV4l2Sys sys({.period_ns = 2'000'000});  // Two of the same microsecond would be a repetition.
  const auto camera = open(sys);
  const std::array<FaultStep, 2> script{{{DeviceFault::kDelayed, 5}, {DeviceFault::kNone, 5}}};
  sys.play(script);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  EXPECT_GE(frames_in(*camera, 40), 10);

  EXPECT_GE(monitor_.counted(CameraVerdict::kStale), 1U);
  EXPECT_LE(monitor_.counted(CameraVerdict::kStale), 5U);
  EXPECT_GE(monitor_.counted(CameraVerdict::kGood), 5U);
}

TEST_F(V4l2CameraTest, a_time_stamp_in_the_future_or_long_past_never_leaves_the_present) {
  FakeV4l2Sys sys;
  const auto camera = open(sys);
  const std::array<FaultStep, 2> script{{{DeviceFault::kClockJump, 3}, {DeviceFault::kDelayed, 3}}};
  sys.play(script);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  for (int i = 0; i < 6; ++i) {
    const auto lease = camera->next(100ms);
    ASSERT_TRUE(lease.ok());
    const DepthFrame& frame = lease.value().frame();
    EXPECT_LE(frame.captured_ns, frame.dequeued_ns);
    EXPECT_GE(frame.captured_ns, frame.dequeued_ns - 5'000'000'000);
  }
}

TEST_F(V4l2CameraTest, silence_is_noticed_and_the_device_opened_again) {
  FakeV4l2Sys sys;
  const auto camera = open(sys);
  const std::array<FaultStep, 2> script{{{DeviceFault::kNone, 2}, {DeviceFault::kOff, 100'000}}};
  sys.play(script);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  for (int i = 0; i < 100 && camera->health().reconnects == 0; ++i) {
    (void)camera->next(20ms);
  }

  EXPECT_GE(camera->health().reconnects, 1U);
}

TEST_F(V4l2CameraTest, a_frame_on_loan_outlives_its_device) {
  FakeV4l2Sys sys;
  const auto camera = open(sys);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  auto held = camera->next(1s);
  ASSERT_TRUE(held.ok());
  const std::byte first = held.value().frame().depth[0];

  sys.unplug();
  (void)frames_in(*camera, 5);
  sys.plug_in();
  ASSERT_GT(frames_in(*camera, 30), 10);

  EXPECT_EQ(held.value().frame().depth[0], first);
  EXPECT_EQ(held.value().frame().depth.back(), first);
}

TEST_F(V4l2CameraTest, two_hundred_disconnects_leak_neither_descriptors_nor_mappings) {
  FakeV4l2Sys sys;
  auto camera = open(sys);
  const std::size_t mapped = sys.num_mapped();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());

  for (std::uint64_t n = 1; n <= 200; ++n) {
    auto held = camera->next(1s);
    sys.unplug();
    (void)camera->next(5ms);
    sys.plug_in();
    for (int i = 0; i < 500 && camera->health().reconnects < n; ++i) {
      (void)camera->next(2ms);
    }
    ASSERT_EQ(camera->health().reconnects, n);
  }
  ASSERT_TRUE(camera->next(1s).ok());

  EXPECT_EQ(sys.num_open(), 1U);
  EXPECT_LE(sys.num_mapped(), mapped + 1);
  camera.reset();
  EXPECT_EQ(sys.num_open() + sys.num_mapped(), 0U);
}

TEST_F(V4l2CameraTest, stop_returns_within_100_ms_in_every_state) {
  FakeV4l2Sys sys;
  const auto camera = open(sys);
  const auto stop_takes = [&] {
    const auto begin = std::chrono::steady_clock::now();
    camera->stop();
    return std::chrono::steady_clock::now() - begin;
  };

  EXPECT_LT(stop_takes(), 100ms);
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  (void)camera->next(1s);
  EXPECT_LT(stop_takes(), 100ms);
  ASSERT_TRUE(camera->start(FrameMode::kLatest).ok());
  sys.unplug();
  (void)camera->next(50ms);
  EXPECT_EQ(camera->state(), V4l2State::kLost);
  EXPECT_LT(stop_takes(), 100ms);
}

}  // namespace
}  // namespace dseam::hal::v4l2
