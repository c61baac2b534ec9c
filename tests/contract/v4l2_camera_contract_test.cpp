// SPDX-License-Identifier: Apache-2.0
#include "depth_camera_contract.hpp"
#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "hal/v4l2/fake_v4l2_sys.hpp"

namespace dseam::test {
namespace {

/// The backend's own code above a fake of the kernel.
class FakeKernelDevice {
 public:
  static constexpr bool kLive = true;
  static constexpr bool kCanUnplug = true;
  static constexpr bool kOwnThreadOnly = false;  // The fake kernel makes its notes on the heap.

  FakeKernelDevice() {
    hal::v4l2::V4l2Config config;
    config.device = "/dev/video0";
    config.model.intrinsics.fx = config.model.intrinsics.fy = 50.0;
    config.first_retry = std::chrono::milliseconds(20);
    std::string problem;
    auto camera = hal::v4l2::V4l2Camera::open(config, sys_, problem);
    EXPECT_TRUE(camera.ok()) << problem;
    camera_ = std::move(camera.value());
  }
  hal::DepthCamera& camera() { return *camera_; }
  std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
  void pass(std::chrono::nanoseconds time) { std::this_thread::sleep_for(time); }
  void unplug() { sys_.unplug(); }
  void plug_in() { sys_.plug_in(); }

 private:
  FakeV4l2Sys sys_{[] {
    FakeV4l2Sys::Setup setup;
    setup.period_ns = 10'000'000;
    return setup;
  }()};
  std::unique_ptr<hal::v4l2::V4l2Camera> camera_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(V4l2OnAFakeKernel, DepthCameraContract, FakeKernelDevice);

}  // namespace
}  // namespace dseam::test
