// SPDX-License-Identifier: Apache-2.0
#include "contract/depth_camera_contract.hpp"
#include "vivid.hpp"

namespace dseam::test {
namespace {

class VividDevice {
 public:
  static constexpr bool kLive = true;
  static constexpr bool kCanUnplug = true;
  static constexpr bool kOwnThreadOnly = true;

  VividDevice() {
    std::string problem;
    auto camera =
        hal::v4l2::V4l2Camera::open(Vivid::config(), hal::v4l2::linux_v4l2_sys(), problem);
    EXPECT_TRUE(camera.ok()) << problem;
    camera_ = std::move(camera.value());
  }
  hal::DepthCamera& camera() { return *camera_; }
  std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch().count(); }
  void pass(std::chrono::nanoseconds time) { std::this_thread::sleep_for(time); }
  void unplug() { EXPECT_TRUE(Vivid::set("Disconnect", 1)); }
  void plug_in() {}  // The driver comes back when its last user has closed it.

 private:
  std::unique_ptr<hal::v4l2::V4l2Camera> camera_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(V4l2OnVivid, DepthCameraContract, VividDevice);

}  // namespace
}  // namespace dseam::test
