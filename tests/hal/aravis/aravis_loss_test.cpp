// SPDX-License-Identifier: Apache-2.0
// A camera that is pulled out and comes back, or does not.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
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

/// When a camera is closed that is gone: right away, as a rule with the library in an access to it.
struct Closing {
  const char* name;
  bool started;
  std::chrono::milliseconds gone_for;
};

void PrintTo(const Closing& closing, std::ostream* out) { *out << closing.name; }

class AravisClose : public AravisCameraTest, public ::testing::WithParamInterface<Closing> {
 protected:
  static auto threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  }
};

TEST_P(AravisClose, of_a_camera_that_is_gone_ends_within_6_s_and_joins_every_thread) {
  FakeGigeCamera device;
  open().reset();  // With the first camera libusb starts a thread of its own, which stays.
  device.unplug();
  const auto before = threads();
  device.plug_in();
  auto camera = open();
  ASSERT_TRUE(!GetParam().started ||
              (camera->start(FrameMode::kEvery).ok() && wait_for_frame(*camera)));
  device.unplug();
  std::this_thread::sleep_for(GetParam().gone_for);

  const auto begin = std::chrono::steady_clock::now();
  camera.reset();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;

  std::cout << "closed in " << took.count() << " s\n";
  EXPECT_LT(took, 6s);
  EXPECT_EQ(threads(), before);
}

INSTANTIATE_TEST_SUITE_P(States, AravisClose,
                         ::testing::Values(Closing{"idle", false, 0ms},
                                           Closing{"streaming", true, 0ms},
                                           Closing{"giving_up", true, 900ms},
                                           Closing{"heartbeat_unanswered", true, 1500ms},
                                           Closing{"looking_for_it", true, 14s}),
                         [](const auto& closing) { return std::string(closing.param.name); });

TEST_F(AravisLoss, closing_a_camera_that_answers_ends_its_acquisition_and_leaves_it_free) {
  const FakeGigeCamera device;
  auto camera = open();
  ASSERT_TRUE(camera->start(FrameMode::kEvery).ok());
  ASSERT_TRUE(wait_for_frame(*camera));

  camera.reset();

  std::uint32_t acquiring = 1;
  arv_fake_camera_read_register(device.fake(), ARV_FAKE_CAMERA_REGISTER_ACQUISITION, &acquiring);
  EXPECT_EQ(acquiring, 0U);
  EXPECT_NE(open(), nullptr);
}

}  // namespace
}  // namespace dseam::hal::aravis
