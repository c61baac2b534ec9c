// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "dseam/hal/socketcan/link_check.hpp"
#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"
#include "robot/last_words.hpp"
#include "robot/robot_side.hpp"

namespace dseam::program {

/// A robot on a CAN interface of Linux, in real time. Whatever ends the process, the abort comes
/// first.
class CanRobotSide final : public RobotSide {
 public:
  /// Opens the interface and sets the calling thread up for real time as far as it is allowed.
  ///
  /// Errors:  throws Failure(kDevice) that names the interface, the fault and the cure.
  CanRobotSide(const std::string& interface, const link::Addressing& addressing);

  hal::CanBus& bus() override { return *bus_; }
  hal::Clock& clock() override { return clock_; }
  rt::Cycle::Tick next_cycle() override { return cycle_.wait(); }
  [[nodiscard]] bool real_time() const override { return real_time_; }
  [[nodiscard]] std::string interface() const override { return interface_; }
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> facts() const override;

 private:
  std::string interface_;
  std::unique_ptr<hal::socketcan::SocketCanBus> bus_;
  rt::MonotonicClock clock_;
  rt::Cycle cycle_;
  bool real_time_;
  LastWords last_words_;
};

/// What the kernel knows of the interface; opens nothing. Throws Failure(kDevice) with the cure
/// where there is none.
hal::socketcan::LinkInfo check_can(const std::string& interface);
/// Opens a CAN interface. Throws Failure(kDevice) with the cure.
[[nodiscard]] std::unique_ptr<hal::socketcan::SocketCanBus> open_can(const std::string& interface,
                                                                     bool classic);

}  // namespace dseam::program
