// SPDX-License-Identifier: Apache-2.0
// A camera that is pulled out and comes back, or does not.
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <thread>

#include "hal/aravis/aravis_camera_fixture.hpp"

namespace dseam::hal::aravis {
namespace {

using AravisLoss = AravisCameraTest;

TEST_F(AravisLoss, after_a_reconnect_the_settings_are_applied_again) {
  FakeGigeCamera device;
  config_.frame_rate_hz = 40.0;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));

  device.unplug();
  for (int i = 0; i < 500 && camera->state() != AravisState::kLost; ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(camera->state(), AravisState::kLost);
  device.plug_in();  // With another frame rate and, as the control program left it, Mono8.
  device.write_register(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, ARV_PIXEL_FORMAT_MONO_8);

  ASSERT_TRUE(wait_for_frame(*camera));
  EXPECT_EQ(camera->health().reconnects, 1U);
  EXPECT_EQ(camera->state(), AravisState::kStreaming);
}

TEST_F(AravisLoss, stop_returns_at_once_also_in_the_middle_of_a_reconnection) {
  FakeGigeCamera device;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));
  device.unplug();
  while (camera->state() != AravisState::kLost) {
    std::this_thread::sleep_for(10ms);
  }
  // From here on the control thread is in Aravis' discovery nearly all the time, a second each.
  for (int i = 0; i < 12; ++i) {
    std::this_thread::sleep_for(237ms);
    const auto begin = std::chrono::steady_clock::now();
    camera->stop();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 100ms);
    EXPECT_EQ(camera->next(0ms).error(), Errc::kUnavailable);
  }
}

TEST_F(AravisLoss, stop_returns_at_once_also_while_the_device_is_gone) {
  FakeGigeCamera device;
  const auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));
  device.unplug();

  for (const auto gone_for : {0ms, 700ms}) {
    std::this_thread::sleep_for(gone_for);
    const auto begin = std::chrono::steady_clock::now();
    camera->stop();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 100ms);
    (void)camera->start(FrameMode::kEvery);
  }
}

TEST_F(AravisLoss, closing_while_the_device_is_gone_ends_and_joins_every_thread) {
  constexpr auto kLibrarysTime = 10s;  // Four accesses to registers, one after the other.
  FakeGigeCamera device;
  const auto threads = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  open().reset();  // With the first camera libusb starts a thread of its own, which stays.
  device.unplug();
  const auto before = threads();
  device.plug_in();
  auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));
  device.unplug();

  const auto begin = std::chrono::steady_clock::now();
  camera.reset();

  EXPECT_LT(std::chrono::steady_clock::now() - begin, kLibrarysTime + 5s);  // A busy computer.
  EXPECT_EQ(threads(), before);
}

}  // namespace
}  // namespace dseam::hal::aravis
