// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "dseam/hal/bus/link_port.hpp"
#include "dseam/hal/clock.hpp"
#include "dseam/hal/pose/interpolated_poses.hpp"
#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "dseam/link/sender.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"

namespace dseam::program {

/// The robot's pose over time from the weld link's pose messages. The link is greeted and never
/// armed. What the robot reports stands for its flange: the hand-eye calibration has to have been
/// made with poses from the same report.
///
/// Context: step() from one thread; the poses from any.
class LinkPoses {
 public:
  /// `session` must be one that was never used.
  ///
  /// Errors:  throws Failure(kUsage) where the link's configuration contradicts itself.
  LinkPoses(hal::CanBus& bus, const link::Sender::Config& config, std::uint32_t session,
            std::int64_t now_ns);

  /// Reads the bus and keeps the link alive; at least every few milliseconds.
  void step(std::int64_t now_ns);
  /// The robot answered, and reports.
  [[nodiscard]] bool reporting() const { return reports_ > 0; }
  [[nodiscard]] hal::RobotState& state() { return poses_; }

 private:
  static constexpr std::size_t kReports = 64;  // More than a second of them.

  hal::LinkPort port_;
  link::Sender sender_;
  std::array<hal::InterpolatedPoses::Slot, kReports> slots_{};
  hal::InterpolatedPoses poses_{slots_};
  std::uint64_t robot_time_us_ = 0;
  std::atomic<std::uint64_t> reports_{0};
};

/// The same on a CAN interface, in a thread of its own for as long as it lives.
class ListeningToRobot {
 public:
  /// Waits for the robot's first report.
  ///
  /// Errors:  throws Failure(kDevice) where the interface cannot be opened or nobody answers.
  ListeningToRobot(const std::string& interface, const link::Sender::Config& config);
  ~ListeningToRobot();
  ListeningToRobot(const ListeningToRobot&) = delete;
  ListeningToRobot& operator=(const ListeningToRobot&) = delete;

  [[nodiscard]] hal::RobotState& state() { return poses_.state(); }
  /// Until there is a report from after `stamp_ns`, or it is clear that none will come.
  void await(std::int64_t stamp_ns);

 private:
  void listen();

  std::unique_ptr<hal::socketcan::SocketCanBus> bus_;
  rt::MonotonicClock clock_;
  LinkPoses poses_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace dseam::program
