// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "depth_camera_contract.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_scanner.hpp"

namespace dseam::test {
namespace {

class SimDevice {
 public:
  static constexpr bool kLive = false;
  static constexpr bool kCanUnplug = false;
  static constexpr bool kOwnThreadOnly = true;

  hal::DepthCamera& camera() { return *scanner_; }
  std::int64_t now_ns() { return static_cast<hal::Clock&>(clock_).now_ns(); }
  void pass(std::chrono::nanoseconds time) { clock_.advance(time.count()); }

 private:
  static std::unique_ptr<hal::sim::SimScanner> make(hal::Clock& clock) {
    hal::sim::CellConfig config;
    config.scanner.width = 128;
    config.scanner.height = 96;
    config.views.count = 3;
    const auto cell = hal::sim::Cell::make(config);
    hal::sim::SimScanner::Options options;
    options.repeat = true;
    return std::move(hal::sim::SimScanner::make(cell.value(), options, clock).value());
  }

  hal::fake::ManualClock clock_{1'000'000'000};
  std::unique_ptr<hal::sim::SimScanner> scanner_ = make(clock_);
};

INSTANTIATE_TYPED_TEST_SUITE_P(Sim, DepthCameraContract, SimDevice);

}  // namespace
}  // namespace dseam::test
