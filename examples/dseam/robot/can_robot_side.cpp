// SPDX-License-Identifier: Apache-2.0
#include "robot/can_robot_side.hpp"

#include "dseam/rt/linux/thread_setup.hpp"
#include "failure.hpp"

namespace dseam::program {
namespace {

bool set_up_for_real_time() {
  const auto granted = rt::set_up_thread({});
  rt::prefault_stack();
  return granted.ok() && granted.value().real_time();
}

[[noreturn]] void fail_to_open(const std::string& interface, Errc error) {
  const auto finding = hal::socketcan::explain_open(interface, error);
  throw Failure(ExitCode::kDevice, "can:" + interface + ": " + finding.text +
                                       (finding.cure.empty() ? "" : " (" + finding.cure + ")"));
}

}  // namespace

hal::socketcan::LinkInfo check_can(const std::string& interface) {
  const auto link = hal::socketcan::read_link(interface);
  if (!link.ok()) {
    fail_to_open(interface, link.error());
  }
  return link.value();
}

std::unique_ptr<hal::socketcan::SocketCanBus> open_can(const std::string& interface, bool classic) {
  hal::socketcan::SocketCanBus::Config config;
  config.fd = !classic;
  auto bus = hal::socketcan::SocketCanBus::open(interface, config);
  if (!bus.ok()) {
    fail_to_open(interface, bus.error());
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
