// SPDX-License-Identifier: Apache-2.0
#include "hal/blank/blank_camera.hpp"

#include <gtest/gtest.h>

namespace dseam::hal::blank {
namespace {

using namespace std::chrono_literals;

// What of the contract a camera without frames can keep; tests/contract has the rest.
TEST(BlankCamera, keeps_what_a_camera_without_a_device_can_keep) {
  BlankCamera camera({.intrinsics = {.width = 8, .height = 6, .fx = 10, .fy = 10}});

  EXPECT_EQ(camera.next(0ns).error(), Errc::kUnavailable);
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());
  EXPECT_EQ(camera.start(FrameMode::kEvery).error(), Errc::kUnavailable);
  EXPECT_EQ(camera.next(1ms).error(), Errc::kTimeout);
  camera.stop();
  camera.stop();
  EXPECT_EQ(camera.next(0ns).error(), Errc::kUnavailable);
  EXPECT_EQ(camera.health().delivered, 0U);
}

}  // namespace
}  // namespace dseam::hal::blank
