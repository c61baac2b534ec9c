// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/rt/cycle.hpp"
#include "dseam/torch/torch_path.hpp"

namespace dseam::program {

/// Whoever is at the other end of the bus, and the time that passes for both.
class RobotSide {
 public:
  RobotSide() = default;
  RobotSide(const RobotSide&) = delete;
  RobotSide& operator=(const RobotSide&) = delete;
  virtual ~RobotSide() = default;

  [[nodiscard]] virtual hal::CanBus& bus() = 0;
  [[nodiscard]] virtual hal::Clock& clock() = 0;
  /// Waits for the next cycle; a simulated robot lives on meanwhile.
  virtual rt::Cycle::Tick next_cycle() = 0;
  /// Whether this end runs as a real-time thread, or time is virtual.
  [[nodiscard]] virtual bool real_time() const = 0;
  [[nodiscard]] virtual std::string interface() const = 0;
  /// What there is to tell of the other end afterwards.
  [[nodiscard]] virtual std::vector<std::pair<std::string, std::string>> facts() const = 0;
};

}  // namespace dseam::program
