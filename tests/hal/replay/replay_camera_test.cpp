// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/replay_camera.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "dseam/hal/fake/manual_clock.hpp"
#include "small_set.hpp"

namespace dseam::test {
namespace {

using namespace std::chrono_literals;
using hal::FrameMode;
using hal::replay::ReplayCamera;

struct Player {
  explicit Player(const ReplayCamera::Options& options, hal::replay::ScanSet set = small_set(4))
      : player(std::move(ReplayCamera::make(std::move(set), options, clock).value())) {}
  hal::DepthCamera& camera() { return *player; }
  std::int64_t now_ns() { return static_cast<hal::Clock&>(clock).now_ns(); }

  hal::fake::ManualClock clock{1'000'000'000};
  std::unique_ptr<ReplayCamera> player;
};

TEST(ReplayCamera, frames_come_with_their_bytes_and_then_the_recording_is_at_its_end) {
  Player p({.step = true});
  const auto set = small_set(4);
  ASSERT_TRUE(p.camera().start(FrameMode::kEvery).ok());
  for (const auto& view : set.views) {
    const auto frame = p.camera().next(1ms);  // Frames are a millisecond apart at least.

    ASSERT_TRUE(frame.ok());
    EXPECT_EQ(std::memcmp(frame.value().frame().depth.data(), view.depth.data(), 16 * 12 * 2), 0);
    EXPECT_EQ(std::memcmp(frame.value().frame().gray.data(), view.gray.data(), 16 * 12), 0);
    EXPECT_EQ(frame.value().frame().device_ns, view.camera.stamp_ns);
  }
  EXPECT_EQ(p.camera().next(1s).error(), Errc::kNotFound);
}

TEST(ReplayCamera, frames_are_due_at_their_stamps_divided_by_the_speed) {
  Player p({.speed = 4.0});
  ASSERT_TRUE(p.camera().start(FrameMode::kEvery).ok());
  const auto first = p.camera().next(1s);
  ASSERT_TRUE(first.ok());

  EXPECT_EQ(p.camera().next(20ms).error(), Errc::kTimeout);
  const auto second = p.camera().next(20ms);

  ASSERT_TRUE(second.ok());
  EXPECT_EQ(second.value().frame().captured_ns - first.value().frame().captured_ns, 25'000'000);
}

TEST(ReplayCamera, in_latest_mode_frames_overtake_each_other) {
  Player p({});
  ASSERT_TRUE(p.camera().start(FrameMode::kLatest).ok());

  p.clock.advance(350'000'000);
  const auto lease = p.camera().next(0ns);

  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(lease.value().frame().sequence, 3U);
  EXPECT_EQ(p.camera().health().skipped, 3U);
}

TEST(ReplayCamera, poses_are_found_at_the_time_of_their_frames_and_nowhere_else) {
  auto set = small_set(3);
  set.views[1].camera.T_base_camera.reset();
  Player p({}, set);
  ASSERT_TRUE(p.camera().start(FrameMode::kEvery).ok());
  for (const auto& view : set.views) {
    const auto lease = p.camera().next(1s);
    ASSERT_TRUE(lease.ok());
    const auto pose = p.player->robot_state().pose_at(lease.value().frame().captured_ns);

    ASSERT_EQ(pose.ok(), view.camera.T_base_camera.has_value());
    if (pose.ok()) {
      EXPECT_LT(
          geometry::difference(pose.value().T_base_reported, *view.camera.T_base_camera).norm(),
          1e-9);
    }
  }
  EXPECT_EQ(p.player->robot_state().pose_at(p.now_ns() - 50'000'000).error(), Errc::kNotFound);
}

TEST(ReplayCamera, flange_poses_are_reported_where_there_is_no_other_or_when_asked_for) {
  auto set = small_set(1);
  set.views[0].camera.T_base_flange = geometry::RigidTransform{};
  Player camera_first({}, set);
  Player flange_first({.flange_poses = true}, set);
  for (Player* p : {&camera_first, &flange_first}) {
    ASSERT_TRUE(p->camera().start(FrameMode::kEvery).ok());
    const auto lease = p->camera().next(1s);
    const auto pose = p->player->robot_state().pose_at(lease.value().frame().captured_ns);

    ASSERT_TRUE(pose.ok());
    EXPECT_EQ(pose.value().of, p == &camera_first ? hal::PoseOf::kCamera : hal::PoseOf::kFlange);
  }
}

TEST(ReplayCamera, a_set_that_no_single_camera_can_have_taken_is_refused_by_view) {
  hal::fake::ManualClock clock;
  auto other_size = small_set(2);
  other_size.views[1].camera.intrinsics.fx += 1.0;
  auto backwards = small_set(3);
  backwards.views[2].camera.stamp_ns = 0;

  const auto size_fault = ReplayCamera::make(other_size, {}, clock);
  const auto stamp_fault = ReplayCamera::make(backwards, {}, clock);

  EXPECT_EQ(size_fault.fault(), "view 1: its camera differs from the first view's");
  EXPECT_EQ(stamp_fault.fault(), "view 2: its stamp is not a millisecond after the one before");
  EXPECT_FALSE(ReplayCamera::make({}, {}, clock).ok());
  EXPECT_FALSE(ReplayCamera::make(small_set(1), {.speed = 0.0}, clock).ok());
}

}  // namespace
}  // namespace dseam::test
