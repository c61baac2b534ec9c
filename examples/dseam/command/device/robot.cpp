// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "command/commands.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"
#include "robot/can_robot_side.hpp"
#include "terminal/interrupt.hpp"

namespace dseam::program {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;

}  // namespace

ExitCode run_robot(const RobotOptions& options, const Invocation& invocation) {
  const std::string& interface = options.interface;
  Settings settings;
  invocation.configure(settings);
  const auto& addressing = settings.session.link.addressing;
  hal::sim::SimRobot::Config config;
  config.receiver.addressing = addressing;
  if (!hal::sim::SimRobot::check(config).ok()) {
    throw Failure(ExitCode::kUsage, "the configured weld link: a limit is out of range");
  }
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  const auto bus = open_can(interface, addressing.classic);
  rt::MonotonicClock clock;
  hal::sim::SimRobot robot(config, *bus);
  std::cout << "robot on " << interface << "; Ctrl-C ends it" << std::endl;
  serve(robot, clock, kPeriodNs, interrupted);
  const link::Receiver& receiver = robot.receiver();
  std::cout << "executed " << robot.executed().size() + robot.not_recorded() << " set points\n"
            << "arc " << (receiver.arc_on() ? "on" : "off") << ", link fault "
            << link::name(receiver.fault()) << '\n';
  return ExitCode::kDone;
}

}  // namespace dseam::program
