// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"

namespace dseam::hal::aravis {

using namespace std::chrono_literals;
using test::FakeGigeCamera;

/// Opens the fake GigE Vision camera.
class AravisCameraTest : public ::testing::Test {
 protected:
  AravisCameraTest() {
    config_.id = FakeGigeCamera::serial();
    config_.pixel_format = "Depth";
    config_.packet_bytes = 8192;
  }
  std::unique_ptr<AravisCamera> open() {
    auto camera = AravisCamera::open(config_, problem_);
    EXPECT_TRUE(camera.ok()) << problem_;
    return camera.ok() ? std::move(camera.value()) : nullptr;
  }
  Errc refusal() {
    const auto camera = AravisCamera::open(config_, problem_);
    EXPECT_FALSE(camera.ok());
    return camera.ok() ? Errc::kIo : camera.error();
  }
  static bool wait_for_frame(DepthCamera& camera) {
    bool came = false;
    for (int i = 0; i < 200 && !came; ++i) {
      came = camera.next(50ms).ok();
    }
    return came;
  }

  AravisConfig config_;
  std::string problem_;
};

}  // namespace dseam::hal::aravis
