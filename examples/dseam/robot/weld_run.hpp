// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "dseam/rt/timing/cycle_times.hpp"
#include "dseam/rt/weld_session.hpp"
#include "robot/robot_side.hpp"
#include "terminal/operator_enable.hpp"

namespace dseam::program {

/// What came of a weld.
struct WeldOutcome {
  bool finished = false;
  bool interrupted = false;
  bool released = false;  ///< The operator took the enable back.
  rt::Fault fault = rt::Fault::kNone;
  std::size_t executed = 0;  ///< Set points, by the robot's newest status.
  rt::Health health;
  link::Sender::Report link;
};

/// Drives one weld session cycle by cycle: greets the robot, plans from where it stands, arms,
/// loads, starts, and follows it to the end or to the fault that ends it. It arms with the
/// operator's enable and stops when that is taken back. An interrupt turns the arc off with the
/// first frame of the cycle that sees it.
class WeldRun {
 public:
  struct Config {
    rt::WeldSession::Config session;
    link::Sender::Config link;
    rt::Workspace workspace;  ///< Of both gates of the session,
    /// Of the arc gate.
    double max_standing_s = static_cast<double>(rt::ArcGate::Config{}.max_standing_ns) / 1e9;
  };
  using Progress = std::function<void(std::size_t executed, std::size_t total)>;
  /// Plans from where the torch stands; empty when there is no path from there.
  using Planner = std::function<trajectory::SetPointView(const torch::TorchPose& now)>;

  /// `bus` is that of `side`, or what records it.
  ///
  /// Errors:  throws Failure(kUsage) where the configuration contradicts itself.
  WeldRun(const Config& config, RobotSide& side, hal::CanBus& bus, OperatorEnable& enable,
          const std::atomic<bool>& interrupted);

  WeldRun(const WeldRun&) = delete;
  WeldRun& operator=(const WeldRun&) = delete;

  WeldOutcome run(const Planner& plan, const Progress& progress);
  [[nodiscard]] const rt::CycleTimes& times() const { return times_; }

 private:
  /// Cycles until `done`, at most `limit_s`; false when a fault or an interrupt came first.
  bool cycle_until(const std::function<bool()>& done, double limit_s);
  bool wait_for_operator();
  bool start(trajectory::SetPointView points);
  bool follow(std::size_t total, const Progress& progress);
  void cycle();
  void end_in_order();
  [[nodiscard]] bool stopped() const;

  RobotSide& side_;
  OperatorEnable& enable_;
  const std::atomic<bool>& interrupted_;
  link::Sender sender_;
  rt::WeldSession session_;
  rt::WeldSession::Inputs inputs_;
  rt::CycleTimes times_;
  bool released_ = false;
  bool ending_ = false;
};

}  // namespace dseam::program
