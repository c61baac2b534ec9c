// SPDX-License-Identifier: Apache-2.0
#include "contract/can_bus_contract.hpp"

#include <memory>

#include "dseam/hal/fake/fake_can_bus.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "hal/socketcan/fake_kernel.hpp"

namespace dseam::test {
namespace {

struct FakeDevice {
  static constexpr bool kCanGoDown = true;
  static constexpr bool kPriority = false;

  FakeDevice() { a_.join(b_); }
  hal::CanBus& a() { return a_; }
  hal::CanBus& b() { return b_; }
  void pass(std::chrono::nanoseconds time) { clock_.advance(time.count()); }
  static bool fd() { return true; }
  static std::uint64_t own_allocations() { return 0; }
  void set_down(bool down) {
    a_.set_state(down ? hal::BusState::kDown : hal::BusState::kErrorActive);
  }

  hal::fake::ManualClock clock_;
  hal::fake::FakeCanBus a_{clock_};
  hal::fake::FakeCanBus b_{clock_};
};

template <bool kFd>
struct SimDevice {
  static constexpr bool kCanGoDown = true;
  static constexpr bool kPriority = true;

  hal::CanBus& a() { return a_; }
  hal::CanBus& b() { return b_; }
  void pass(std::chrono::nanoseconds time) { clock_.advance(time.count()); }
  static bool fd() { return kFd; }
  static std::uint64_t own_allocations() { return 0; }
  void set_down(bool down) {
    bus_.set_state(down ? hal::BusState::kBusOff : hal::BusState::kErrorActive);
  }

  static hal::sim::SimBus::Config config() {
    hal::sim::SimBus::Config config;
    config.fd = kFd;
    return config;
  }
  hal::fake::ManualClock clock_;
  hal::sim::SimBus bus_{config(), clock_};
  hal::CanBus& a_ = bus_.connect();
  hal::CanBus& b_ = bus_.connect();
};

/// The real backend on a kernel that is not.
template <bool kFd>
struct SocketCanDevice {
  static constexpr bool kCanGoDown = true;
  static constexpr bool kPriority = true;

  SocketCanDevice() { kernel_.set_receive_room(500); }
  hal::CanBus& a() { return *a_; }
  hal::CanBus& b() { return *b_; }
  void pass(std::chrono::nanoseconds time) { kernel_.pass(time.count()); }
  static bool fd() { return kFd; }
  std::uint64_t own_allocations() const { return kernel_.allocations(); }
  void set_down(bool down) { kernel_.set_up(!down); }

  std::unique_ptr<hal::socketcan::SocketCanBus> open() {
    hal::socketcan::SocketCanBus::Config config;
    config.fd = kFd;
    return std::move(hal::socketcan::SocketCanBus::open("can0", config, kernel_).value());
  }
  FakeKernel kernel_{kFd};
  std::unique_ptr<hal::socketcan::SocketCanBus> a_ = open();
  std::unique_ptr<hal::socketcan::SocketCanBus> b_ = open();
};

using Devices = ::testing::Types<FakeDevice, SimDevice<true>, SimDevice<false>,
                                 SocketCanDevice<true>, SocketCanDevice<false>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Backends, CanBusContract, Devices);

}  // namespace
}  // namespace dseam::test
