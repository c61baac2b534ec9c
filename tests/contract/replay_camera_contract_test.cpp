// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "depth_camera_contract.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/replay/replay_camera.hpp"
#include "hal/replay/small_set.hpp"

namespace dseam::test {
namespace {

class ReplayDevice {
 public:
  static constexpr bool kLive = true;
  static constexpr bool kCanUnplug = false;
  static constexpr bool kOwnThreadOnly = true;

  hal::DepthCamera& camera() { return *player_; }
  std::int64_t now_ns() { return static_cast<hal::Clock&>(clock_).now_ns(); }
  void pass(std::chrono::nanoseconds time) { clock_.advance(time.count()); }

 private:
  hal::fake::ManualClock clock_{1'000'000'000};
  std::unique_ptr<hal::replay::ReplayCamera> player_ =
      std::move(hal::replay::ReplayCamera::make(small_set(4), {.repeat = true}, clock_).value());
};

INSTANTIATE_TYPED_TEST_SUITE_P(Replay, DepthCameraContract, ReplayDevice);

}  // namespace
}  // namespace dseam::test
