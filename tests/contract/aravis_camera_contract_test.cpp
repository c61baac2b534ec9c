// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "depth_camera_contract.hpp"
#include "dseam/hal/aravis/aravis_camera.hpp"
#include "hal/aravis/fake/fake_gige_camera.hpp"

namespace dseam::test {
namespace {

std::unique_ptr<hal::aravis::AravisCamera> open_camera(hal::aravis::AravisConfig config) {
  config.pixel_format = "Depth";
  std::string problem;
  auto camera = hal::aravis::AravisCamera::open(config, problem);
  EXPECT_TRUE(camera.ok()) << problem;
  return camera.ok() ? std::move(camera.value()) : nullptr;
}

/// Time as it is for devices that live outside of us.
class RealTimeDevice {
 public:
  static constexpr bool kLive = true;
  static constexpr bool kOwnThreadOnly = false;

  std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
  void pass(std::chrono::nanoseconds time) { std::this_thread::sleep_for(time); }
};

/// GigE Vision over the loopback: Aravis at both ends, our description between them.
class GigeDevice : public RealTimeDevice {
 public:
  static constexpr bool kCanUnplug = true;

  hal::DepthCamera& camera() { return *camera_; }
  void unplug() { device_.unplug(); }
  void plug_in() { device_.plug_in(); }

 private:
  FakeGigeCamera device_;
  std::unique_ptr<hal::aravis::AravisCamera> camera_ = open_camera([] {
    hal::aravis::AravisConfig config;
    config.id = FakeGigeCamera::serial();
    config.packet_bytes = 8192;
    return config;
  }());
};

/// Aravis' fake inside the process, whose description says nothing of 3D.
class InProcessDevice : public RealTimeDevice {
 public:
  static constexpr bool kCanUnplug = false;

  InProcessDevice() {
    static const std::string description = [] {
      const std::string path = "/tmp/dseam-fake3d-in-process-" + std::to_string(getpid()) + ".xml";
      FakeScan3d scan;
      scan.described = false;
      scan.pixel_format = ARV_PIXEL_FORMAT_MONO_16;  // The depth format that it can paint.
      std::ofstream(path) << genicam_description(scan);
      return path;
    }();
    arv_set_fake_camera_genicam_filename(description.c_str());
    hal::aravis::AravisConfig config;
    config.id = "Fake_1";
    config.assumed_model = depth::DepthModel{.intrinsics = {.fx = 800.0, .fy = 800.0}};
    camera_ = open_camera(config);
  }
  hal::DepthCamera& camera() { return *camera_; }

 private:
  std::unique_ptr<hal::aravis::AravisCamera> camera_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(AravisGige, DepthCameraContract, GigeDevice);
INSTANTIATE_TYPED_TEST_SUITE_P(AravisFake, DepthCameraContract, InProcessDevice);

}  // namespace
}  // namespace dseam::test
