// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/replay/recorder.hpp"

#include <gtest/gtest.h>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/replay/replay_camera.hpp"
#include "small_set.hpp"

namespace dseam::test {
namespace {

using namespace std::chrono_literals;
using hal::replay::Recorder;
using hal::replay::ReplayCamera;

TEST(Recorder, what_a_camera_gave_is_played_again_with_its_poses) {
  const ScratchFolder folder("recorder");
  const auto set = small_set(3);
  hal::fake::ManualClock clock(1'000'000'000);
  const auto player = std::move(ReplayCamera::make(set, {}, clock).value());
  hal::DepthCamera& camera = *player;
  auto recorder = Recorder::make(camera.model(), folder / "set");
  ASSERT_TRUE(recorder.ok());
  ASSERT_TRUE(camera.start(hal::FrameMode::kEvery).ok());

  for (std::size_t i = 0; i < set.views.size(); ++i) {
    const auto lease = camera.next(1s);
    const auto pose = player->robot_state().pose_at(lease.value().frame().captured_ns);
    ASSERT_FALSE(recorder.value().add(lease.value().frame(), pose.value()));
  }
  ASSERT_FALSE(recorder.value().commit());

  const auto read = hal::replay::read_scan_set(folder / "set");
  ASSERT_TRUE(read.ok()) << read.fault();
  for (std::size_t i = 0; i < set.views.size(); ++i) {
    EXPECT_EQ(read.value().views[i].depth, set.views[i].depth);
    EXPECT_EQ(read.value().views[i].gray, set.views[i].gray);
    EXPECT_LT(geometry::difference(*read.value().views[i].camera.T_base_camera,
                                   *set.views[i].camera.T_base_camera)
                  .norm(),
              1e-9);
  }
}

TEST(Recorder, a_frame_shorter_than_its_model_is_refused) {
  const ScratchFolder folder("recorder");
  hal::fake::ManualClock clock;
  const auto player = std::move(ReplayCamera::make(small_set(1), {}, clock).value());
  hal::DepthCamera& camera = *player;
  auto recorder = Recorder::make(camera.model(), folder / "set");
  const std::vector<std::byte> half(16 * 12);

  const auto fault = recorder.value().add({.depth = half, .gray = half}, std::nullopt);

  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->text, "frame 0 is shorter than its model says");
}

}  // namespace
}  // namespace dseam::test
