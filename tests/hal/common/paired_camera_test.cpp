// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/camera/paired_camera.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "dseam/hal/fake/fake_camera.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::hal {
namespace {

using fake::DeviceFault;
using fake::FakeCamera;
using fake::FaultStep;
using namespace std::chrono_literals;

constexpr std::int64_t kPeriodNs = 33'000'000;
constexpr std::int64_t kApartNs = 5'000'000;

depth::DepthModel model_of(bool gray) {
  depth::DepthModel model;
  model.intrinsics = {.width = 8, .height = 4, .fx = 10.0, .fy = 10.0, .cx = 3.5, .cy = 1.5};
  model.has_gray = gray;
  return model;
}

/// Two fakes on one clock, of which each plays a script of its own.
class PairedCameraTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kFrames = 6;

  FakeCamera fake(bool gray, std::span<std::byte> pool) {
    return FakeCamera(
        {.model = model_of(gray),
         .period_ns = kPeriodNs,
         .depth = depth_,
         .gray = gray ? std::span<const std::byte>(gray_) : std::span<const std::byte>(),
         .pool = pool},
        clock_);
  }

  void start() {
    depth_camera_.play(depth_script_);
    gray_camera_.play(gray_script_);
    ASSERT_TRUE(paired_.start(FrameMode::kEvery).ok());
  }

  std::vector<FaultStep> depth_script_{{DeviceFault::kNone, 20}};
  std::vector<FaultStep> gray_script_{{DeviceFault::kNone, 20}};
  fake::ManualClock clock_{1'000'000'000};
  std::vector<std::byte> depth_ = std::vector<std::byte>(64, std::byte{1});
  std::vector<std::byte> gray_ = std::vector<std::byte>(32, std::byte{9});
  std::vector<std::byte> depth_pool_ =
      std::vector<std::byte>(FakeCamera::pool_bytes(model_of(false), kFrames));
  std::vector<std::byte> gray_pool_ =
      std::vector<std::byte>(FakeCamera::pool_bytes(model_of(true), kFrames));
  FakeCamera depth_camera_ = fake(false, depth_pool_);
  FakeCamera gray_camera_ = fake(true, gray_pool_);
  PairedCamera paired_{depth_camera_, gray_camera_, kApartNs};
};

TEST_F(PairedCameraTest, a_frame_has_the_depth_of_one_and_the_gray_of_the_other) {
  ASSERT_TRUE(PairedCamera::check(depth_camera_, gray_camera_).ok());
  start();

  const auto lease = paired_.next(100ms);

  ASSERT_TRUE(lease.ok());
  EXPECT_TRUE(paired_.model().has_gray);
  ASSERT_EQ(lease.value().frame().gray.size(), gray_.size());
  EXPECT_EQ(lease.value().frame().gray[0], std::byte{9});
  EXPECT_EQ(lease.value().frame().depth.size(), depth_.size());
}

TEST_F(PairedCameraTest, a_depth_frame_without_its_gray_is_passed_over_and_counted) {
  gray_script_ = {{DeviceFault::kNone, 2}, {DeviceFault::kLost, 1}, {DeviceFault::kNone, 10}};
  start();
  std::uint32_t gaps = 0;

  for (int i = 0; i < 5; ++i) {
    const auto lease = paired_.next(100ms);
    ASSERT_TRUE(lease.ok()) << name(lease.error());
    EXPECT_FALSE(lease.value().frame().gray.empty());
    gaps += lease.value().frame().gap;
  }

  EXPECT_EQ(gaps, 1U);
  EXPECT_EQ(paired_.health().lost, 1U);
  EXPECT_EQ(paired_.health().delivered, 5U);
}

TEST_F(PairedCameraTest, a_gray_frame_without_its_depth_is_dropped) {
  depth_script_ = {{DeviceFault::kNone, 2}, {DeviceFault::kLost, 1}, {DeviceFault::kNone, 10}};
  start();

  for (int i = 0; i < 5; ++i) {
    const auto lease = paired_.next(100ms);
    ASSERT_TRUE(lease.ok()) << name(lease.error());
  }

  EXPECT_EQ(paired_.health().lost, 1U);
}

TEST_F(PairedCameraTest, both_loans_end_with_the_pair_and_nothing_is_allocated) {
  start();
  const test::AllocationCounter counter;
  {
    const auto lease = paired_.next(100ms);
    EXPECT_EQ(depth_camera_.num_lent(), 1U);
    EXPECT_EQ(gray_camera_.num_lent(), 1U);
  }

  EXPECT_EQ(depth_camera_.num_lent(), 0U);
  EXPECT_EQ(gray_camera_.num_lent(), 0U);
  EXPECT_EQ(counter.count(), 0U);
}

TEST_F(PairedCameraTest, cameras_of_other_sizes_or_without_gray_are_refused) {
  std::vector<std::byte> pool(FakeCamera::pool_bytes(model_of(true), 2));
  depth::DepthModel wide = model_of(true);
  wide.intrinsics.width = 4;
  const FakeCamera other({.model = wide, .depth = depth_, .gray = gray_, .pool = pool}, clock_);

  EXPECT_EQ(PairedCamera::check(depth_camera_, other).error(), Errc::kInvalidArgument);
  EXPECT_EQ(PairedCamera::check(depth_camera_, depth_camera_).error(), Errc::kInvalidArgument);
}

TEST_F(PairedCameraTest, the_loss_of_either_camera_is_told) {
  gray_script_ = {{DeviceFault::kUnplugged, 20}};
  start();

  EXPECT_EQ(paired_.next(100ms).error(), Errc::kDisconnected);
}

}  // namespace
}  // namespace dseam::hal
