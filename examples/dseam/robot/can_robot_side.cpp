// SPDX-License-Identifier: Apache-2.0
#include "robot/can_robot_side.hpp"

#include "dseam/rt/linux/thread_setup.hpp"
#include "failure.hpp"

namespace dseam::program {
namespace {

const char* cure_of(Errc error) {
  switch (error) {
    case Errc::kNotFound:
      return "no such interface; `ip link` lists them";
    case Errc::kUnavailable:
      return "not permitted; CAP_NET_RAW or root is needed";
    case Errc::kUnsupported:
      return "no CAN FD here (`ip link set ... mtu 72`, or --set link.classic=true), or no CAN in "
             "this kernel (`modprobe can_raw`)";
    default:
      return "cannot be opened; is it up? (`ip link set ... up`)";
  }
}

bool set_up_for_real_time() {
  const auto granted = rt::set_up_thread({});
  rt::prefault_stack();
  return granted.ok() && granted.value().real_time();
}

}  // namespace

std::unique_ptr<hal::socketcan::SocketCanBus> open_can(const std::string& interface, bool classic) {
  hal::socketcan::SocketCanBus::Config config;
  config.fd = !classic;
  auto bus = hal::socketcan::SocketCanBus::open(interface, config);
  if (!bus.ok()) {
    throw Failure(ExitCode::kDevice, "can:" + interface + ": " + cure_of(bus.error()));
  }
  return std::move(bus.value());
}

CanRobotSide::CanRobotSide(const std::string& interface, const link::Addressing& addressing)
    : interface_(interface),
      bus_(open_can(interface, addressing.classic)),
      cycle_(rt::Cycle::make({}, clock_).value()),
      real_time_(set_up_for_real_time()),
      last_words_(interface, addressing) {}

std::vector<std::pair<std::string, std::string>> CanRobotSide::facts() const {
  const hal::BusHealth health = bus_->health();
  return {{"cycle", real_time_ ? "real-time thread" : "not a real-time thread"},
          {"periods skipped", std::to_string(cycle_.skipped())},
          {"frames confirmed on the bus", std::to_string(health.confirmed)},
          {"error frames", std::to_string(health.error_frames)}};
}

}  // namespace dseam::program
