// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "dseam/base/arena.hpp"
#include "dseam/hal/bus/link_port.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/link/receiver.hpp"

namespace dseam::hal::sim {

/// What the robot did, and when.
struct ExecutedPoint {
  link::DuePoint due;
  std::int64_t at_ns = 0;
};

/// The reference robot: the other end of the weld link on any CanBus. It shares no object with the
/// host, knows only what is on the bus, and moves ideally along the points it was sent.
///
/// Memory:  buffer and record are made at construction; step() allocates nothing.
/// Context: one thread.
class SimRobot {
 public:
  struct Config {
    link::Receiver::Config receiver;
    std::uint16_t buffer_points = 1024;
    std::size_t record_points = 100'000;  ///< Further ones are executed, but not recorded.
    torch::TorchPose home;                ///< Where it stands before the first point.
    link::RobotCondition condition{.enabled = true};
  };

  /// Errors:  kInvalidArgument: as link::Receiver::make().
  [[nodiscard]] static Result<> check(const Config& config) noexcept;
  /// `config` must pass check().
  SimRobot(const Config& config, CanBus& bus);
  SimRobot(const SimRobot&) = delete;
  SimRobot& operator=(const SimRobot&) = delete;

  /// Everything that is due at `now_ns`; call at least every millisecond.
  void step(std::int64_t now_ns) noexcept;
  /// Somebody stops it, or lets go of its enabling device: it tells the host and moves on.
  void report_condition(const link::RobotCondition& condition) noexcept {
    receiver_.report_condition(condition);
  }

  [[nodiscard]] std::span<const ExecutedPoint> executed() const noexcept { return executed_; }
  [[nodiscard]] std::uint64_t not_recorded() const noexcept { return not_recorded_; }
  [[nodiscard]] const torch::TorchPose& pose() const noexcept { return pose_; }
  [[nodiscard]] const link::Receiver& receiver() const noexcept { return receiver_; }
  [[nodiscard]] const LinkPort& port() const noexcept { return port_; }

 private:
  void execute(std::int64_t now_ns) noexcept;
  void move() noexcept;

  std::vector<std::byte> memory_;
  Arena arena_;
  link::Receiver receiver_;
  LinkPort port_;
  std::vector<ExecutedPoint> executed_;
  std::uint64_t not_recorded_ = 0;
  trajectory::SetPoint last_;
  torch::TorchPose pose_;
};

/// Runs `robot` until `stop` is set: the body of `dseam robot`.
void serve(SimRobot& robot, Clock& clock, std::int64_t period_ns, const std::atomic<bool>& stop);

}  // namespace dseam::hal::sim
