// SPDX-License-Identifier: Apache-2.0
// Every system call of the real backend fails once, and from there on for ever.
#include <gtest/gtest.h>

#include <array>
#include <cerrno>

#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "hal/socketcan/fake_kernel.hpp"

namespace dseam::test {
namespace {

using hal::BusState;
using hal::CanFrame;
using hal::socketcan::SocketCanBus;
using namespace std::chrono_literals;

constexpr std::array kErrors = {EAGAIN, EBADF,  EACCES,      EBUSY,    ECONNRESET, EFAULT,
                                EINTR,  EINVAL, EIO,         ENETDOWN, ENOBUFS,    ENODEV,
                                ENOMEM, ENXIO,  ENETUNREACH, EPERM};

bool exchange(SocketCanBus& bus, FakeKernel& kernel, std::chrono::nanoseconds timeout) {
  CanFrame frame;
  frame.id = 0x123;
  const bool sent = bus.send(frame).ok();
  const auto received = bus.receive(timeout);
  const bool quiet = !received.ok() && received.error() == Errc::kTimeout;
  EXPECT_TRUE(quiet || received.ok() || received.error() == Errc::kDisconnected);
  kernel.pass(20'000'000);
  return sent && (quiet || received.ok());
}

struct Life {
  bool opened = false;
  bool well = false;  ///< The last exchange got through.
  bool told = false;  ///< Else a state or a counter says that something is wrong.
  int calls = 0;      ///< Before it was given time to recover.
};

Life live(FakeKernel& kernel) {
  Life life;
  auto opened = SocketCanBus::open("can0", {}, kernel);
  life.opened = opened.ok();
  if (!life.opened) {
    return life;
  }
  SocketCanBus& bus = *opened.value();
  for (int i = 0; i < 30; ++i) {
    (void)exchange(bus, kernel, i % 4 == 0 ? 1ms : 0ms);
  }
  life.calls = kernel.calls();
  for (int i = 0; i < 10; ++i) {
    life.well = exchange(bus, kernel, 0ms);
  }
  const hal::BusHealth health = bus.health();
  EXPECT_LE(health.confirmed, health.sent);
  life.told = health.state != BusState::kErrorActive || health.send_dropped > 0;
  (void)bus.purge();
  return life;
}

int calls_of_a_life() {
  FakeKernel kernel;
  const Life life = live(kernel);
  EXPECT_TRUE(life.well);
  return life.calls;
}

TEST(SocketCanSweep, one_failed_call_is_survived_or_named_and_nothing_leaks) {
  const int calls = calls_of_a_life();
  std::uint64_t injected = 0;
  for (const int error : kErrors) {
    for (int call = 0; call < calls; ++call) {
      FakeKernel kernel;
      kernel.sabotage({call, error, false});

      const Life life = live(kernel);

      injected += kernel.sabotaged();
      EXPECT_TRUE(life.well || !life.opened) << call << " " << error;
      ASSERT_EQ(kernel.open_sockets(), 0U) << call << " " << error;
    }
  }
  EXPECT_EQ(injected, kErrors.size() * static_cast<std::size_t>(calls));
}

TEST(SocketCanSweep, calls_that_fail_for_ever_end_in_a_named_state_and_nothing_leaks) {
  const int calls = calls_of_a_life();
  for (const int error : kErrors) {
    for (int call = 0; call < calls; ++call) {
      FakeKernel kernel;
      kernel.sabotage({call, error, true});

      const Life life = live(kernel);

      EXPECT_TRUE(life.well || life.told || !life.opened) << call << " " << error;
      ASSERT_EQ(kernel.open_sockets(), 0U) << call << " " << error;
      ASSERT_LT(kernel.calls(), 20'000) << call << " " << error;
    }
  }
}

}  // namespace
}  // namespace dseam::test
