// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "robot/robot_side.hpp"

namespace dseam::program {

/// The simulated robot on a simulated bus, in virtual time: a weld of a minute takes a second, and
/// each run gives the same bits.
class SimRobotSide final : public RobotSide {
 public:
  /// The robot waits at `home`.
  explicit SimRobotSide(const torch::TorchPose& home);

  hal::CanBus& bus() override { return host_port_; }
  hal::Clock& clock() override { return clock_; }
  rt::Cycle::Tick next_cycle() override;
  [[nodiscard]] bool real_time() const override { return true; }
  [[nodiscard]] std::string interface() const override { return "sim"; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> facts() const override;

  [[nodiscard]] const hal::sim::SimRobot& robot() const { return robot_; }
  [[nodiscard]] hal::sim::SimRobot& robot() { return robot_; }

 private:
  hal::fake::ManualClock clock_;
  hal::sim::SimBus bus_;
  hal::sim::SimBus::Endpoint& host_port_;
  hal::sim::SimRobot robot_;
};

}  // namespace dseam::program
