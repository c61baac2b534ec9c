// SPDX-License-Identifier: Apache-2.0
// What the program asks of a GenICam camera, against one over the loopback.
#include <gtest/gtest.h>

#include "failure.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"
#include "scan/live_scan.hpp"

namespace dseam::program {
namespace {

using test::FakeGigeCamera;

std::unique_ptr<ScanSource> open(const LiveSettings& settings) {
  return open_live_scan("aravis", FakeGigeCamera::serial(), settings, {});
}

std::string refusal(const LiveSettings& settings) {
  try {
    (void)open(settings);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::kDevice);
    return failure.what();
  }
  return "";
}

TEST(LiveCamera, names_itself_for_its_gray_image_to_send_both_in_one_frame) {
  const FakeGigeCamera device({.multipart = true});
  LiveSettings settings;
  settings.gray_device = FakeGigeCamera::serial();

  const auto scan = open(settings);

  EXPECT_TRUE(scan->camera().model().has_gray);
}

TEST(LiveCamera, without_a_description_takes_that_of_the_settings) {
  const FakeGigeCamera device({.described = false});
  LiveSettings settings;
  EXPECT_NE(refusal(settings).find("camera.mm_per_count"), std::string::npos);

  settings.mm_per_count = 0.05;
  settings.focal_px = 512.0;
  settings.width = 320;
  settings.height = 240;
  const auto scan = open(settings);

  EXPECT_EQ(scan->camera().model().scale[2], 0.05);
  EXPECT_EQ(scan->camera().model().intrinsics.cx, 159.5);
}

}  // namespace
}  // namespace dseam::program
