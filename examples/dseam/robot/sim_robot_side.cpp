// SPDX-License-Identifier: Apache-2.0
#include "robot/sim_robot_side.hpp"

namespace dseam::program {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;

hal::sim::SimRobot::Config at_home(const torch::TorchPose& home) {
  hal::sim::SimRobot::Config config;
  config.home = home;
  return config;
}

}  // namespace

SimRobotSide::SimRobotSide(const torch::TorchPose& home)
    : clock_(kPeriodNs),
      bus_({}, clock_),
      host_port_(bus_.connect()),
      robot_(at_home(home), bus_.connect()) {}

rt::Cycle::Tick SimRobotSide::next_cycle() {
  clock_.advance(kPeriodNs);
  robot_.step(clock_.now_ns());
  return {.due_ns = clock_.now_ns(), .woke_ns = clock_.now_ns()};
}

std::vector<std::pair<std::string, std::string>> SimRobotSide::facts() const {
  const link::Receiver::Report& report = robot_.receiver().report();
  return {{"robot executed", std::to_string(robot_.executed().size()) + " set points"},
          {"robot rejected", std::to_string(report.damaged + report.malformed) + " frames"},
          {"robot arc at the end", robot_.receiver().arc_on() ? "on" : "off"}};
}

}  // namespace dseam::program
