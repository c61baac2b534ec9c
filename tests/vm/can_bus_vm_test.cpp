// SPDX-License-Identifier: Apache-2.0
// The CAN contract and the weld link on the kernel's own drivers: vcan, vxcan and an emulated
// Kvaser pair (sja1000). The guest's init made and configured the interfaces.
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include "contract/can_bus_contract.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/hal/socketcan/link_check.hpp"
#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "hal/sim_robot/weld_tally.hpp"

namespace dseam::test {
namespace {

using hal::socketcan::SocketCanBus;

std::unique_ptr<SocketCanBus> open(const char* interface, bool fd) {
  SocketCanBus::Config config;
  config.fd = fd;
  auto opened = SocketCanBus::open(interface, config);
  EXPECT_TRUE(opened.ok()) << interface << ": " << name(opened.error());
  return std::move(opened.value());
}

struct Vcan {
  static constexpr const char* kA = "vcan0";
  static constexpr const char* kB = "vcan0";
  static constexpr bool kFd = true;
};
struct Vxcan {
  static constexpr const char* kA = "vxcan0";
  static constexpr const char* kB = "vxcan1";
  static constexpr bool kFd = true;
};
struct Kvaser {
  static constexpr const char* kA = "can0";
  static constexpr const char* kB = "can1";
  static constexpr bool kFd = false;
};

template <typename Pair>
struct KernelDevice {
  static constexpr bool kCanGoDown = true;
  static constexpr bool kPriority = true;

  ~KernelDevice() { set_down(false); }
  hal::CanBus& a() { return *a_; }
  hal::CanBus& b() { return *b_; }
  static void pass(std::chrono::nanoseconds time) {
    const timespec wait{0, std::min<long>(time.count(), 999'999'999)};
    nanosleep(&wait, nullptr);
  }
  static bool fd() { return Pair::kFd; }
  static std::uint64_t own_allocations() { return 0; }
  static void set_down(bool down) {
    const std::string command = std::string("ip link set ") + Pair::kA + (down ? " down" : " up");
    ASSERT_EQ(std::system(command.c_str()), 0);
  }

  std::unique_ptr<SocketCanBus> a_ = open(Pair::kA, Pair::kFd);
  std::unique_ptr<SocketCanBus> b_ = open(Pair::kB, Pair::kFd);
};

using Devices = ::testing::Types<KernelDevice<Vcan>, KernelDevice<Vxcan>, KernelDevice<Kvaser>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Kernel, CanBusContract, Devices);

TEST(LinkOnVcan, the_interfaces_are_described_as_they_were_configured) {
  const auto vcan = hal::socketcan::read_link("vcan0");
  const auto can = hal::socketcan::read_link("can0");

  ASSERT_TRUE(vcan.ok());
  ASSERT_TRUE(can.ok());
  EXPECT_EQ(vcan.value().kind, "vcan");
  EXPECT_EQ(vcan.value().mtu, 72U);
  EXPECT_EQ(can.value().kind, "can");
  EXPECT_EQ(can.value().bits_per_s, 500'000U);
}

/// Faster than life: the link's time is virtual, the bus is the kernel's.
std::size_t points_wanted() {
  const char* wanted = std::getenv("DSEAM_VCAN_POINTS");
  return wanted == nullptr ? 20'000 : std::strtoul(wanted, nullptr, 10);
}

/// Between the host and the kernel's bus lies a simulated one that loses, doubles, delays and
/// spoils frames both ways.
TEST(LinkOnVcan, points_over_a_faulty_way_are_executed_once_in_order_and_unspoilt) {
  constexpr std::size_t kPointsAWeld = 5'000;
  const auto gateway = open("vcan0", true);
  const auto robots = open("vcan0", true);
  LinkCell cell(*robots, *gateway, seeded(1), recording(points_wanted() + 200'000));
  cell.bus_.set_faults(faults_of_every_kind(5e-4, 2e-4));
  Tally tally;

  for (std::uint32_t session = 1; tally.executed < points_wanted() && session < 2000; ++session) {
    weld_once(cell, session, kPointsAWeld, tally);
  }

  std::cout << tally.executed << " points over vcan, " << cell.bus_.fault_counts().total()
            << " faults, " << tally.done << " welds done, " << tally.tripped << " tripped, "
            << tally.wrong << " wrong, " << tally.foreign << " of another session\n";
  EXPECT_GE(tally.executed, points_wanted());
  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_EQ(tally.foreign, 0U);
  EXPECT_GE(tally.done, 1U);
  EXPECT_GE(cell.bus_.fault_counts().total(), points_wanted() / 1000);
}

TEST(LinkOnVcan, a_long_path_is_executed_once_in_order_and_whole) {
  constexpr std::size_t kPoints = 20'000;
  const auto host_bus = open("vcan0", true);
  const auto robot_bus = open("vcan0", true);
  hal::fake::ManualClock clock(1'000'000'000);
  hal::sim::SimRobot::Config config;
  config.record_points = kPoints;
  hal::sim::SimRobot robot(config, *robot_bus);
  hal::LinkPort port(*host_bus);
  link::Sender sender = link::Sender::make({}).value();
  auto points = round_weld(kPoints, 1000);

  auto progress = link::WeldProgress::kUnderWay;
  while (progress == link::WeldProgress::kUnderWay) {
    clock.advance(LinkCell::kStepNs);
    progress = link::give_next_order(sender, {9, 1, points, true}, clock.now_ns());
    port.turn(sender, clock.now_ns());
    robot.step(clock.now_ns());
  }

  ASSERT_EQ(progress, link::WeldProgress::kDone) << link::name(sender.fault());
  ASSERT_EQ(robot.executed().size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(robot.executed()[i].due.index, i);
    ASSERT_LE((robot.executed()[i].due.point.pose.p_base - points[i].pose.p_base).norm(), 0.001);
  }
}

}  // namespace
}  // namespace dseam::test
