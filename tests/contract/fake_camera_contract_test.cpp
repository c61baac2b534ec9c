// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <vector>

#include "depth_camera_contract.hpp"
#include "dseam/hal/fake/fake_camera.hpp"
#include "dseam/hal/fake/manual_clock.hpp"

namespace dseam::test {
namespace {

class FakeDevice {
 public:
  static constexpr bool kLive = true;
  static constexpr bool kCanUnplug = true;
  static constexpr bool kOwnThreadOnly = true;

  FakeDevice() { plug_in(); }
  hal::DepthCamera& camera() { return camera_; }
  std::int64_t now_ns() { return static_cast<hal::Clock&>(clock_).now_ns(); }
  void pass(std::chrono::nanoseconds time) { clock_.advance(time.count()); }
  void unplug() { camera_.play(kGone); }
  void plug_in() { camera_.play(kThere); }

 private:
  static constexpr std::array<hal::fake::FaultStep, 1> kThere{
      {{hal::fake::DeviceFault::kNone, 100'000}}};
  static constexpr std::array<hal::fake::FaultStep, 1> kGone{
      {{hal::fake::DeviceFault::kUnplugged, 100'000}}};
  static depth::DepthModel model() {
    return {.intrinsics = {.width = 32, .height = 24, .fx = 50, .fy = 50, .cx = 15.5, .cy = 11.5},
            .scale = {1.0, 1.0, 1.0 / 64.0},
            .has_gray = true};
  }

  std::vector<std::byte> depth_{32 * 24 * 2, std::byte{0x40}};
  std::vector<std::byte> gray_{32 * 24, std::byte{100}};
  std::vector<std::byte> pool_ =
      std::vector<std::byte>(hal::fake::FakeCamera::pool_bytes(model(), 8));
  hal::fake::ManualClock clock_;
  hal::fake::FakeCamera camera_{{.model = model(), .depth = depth_, .gray = gray_, .pool = pool_},
                                clock_};
};

INSTANTIATE_TYPED_TEST_SUITE_P(Fake, DepthCameraContract, FakeDevice);

}  // namespace
}  // namespace dseam::test
