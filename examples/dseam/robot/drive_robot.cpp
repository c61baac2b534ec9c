// SPDX-License-Identifier: Apache-2.0
#include "robot/drive_robot.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>

#include "dseam/hal/candump/recording_bus.hpp"
#include "failure.hpp"
#include "robot/can_robot_side.hpp"
#include "robot/sim_robot_side.hpp"

namespace dseam::program {
namespace {

constexpr std::size_t kRecordedFrames = 1U << 18U;  // Ten minutes of an armed link, each way.

std::unique_ptr<RobotSide> open_robot(const std::string& robot, const WeldRun::Config& config,
                                      const MotionJob& motion) {
  if (robot == "sim") {
    return std::make_unique<SimRobotSide>(motion.points().front().pose);
  }
  return std::make_unique<CanRobotSide>(robot.substr(4), config.link.addressing);
}

/// No simulated robot and no virtual bus: there is iron that moves.
bool is_real(const std::string& robot) {
  if (!robot.starts_with("can:")) {
    return false;
  }
  const std::string kind = check_can(robot.substr(4)).kind;
  return kind != "vcan" && kind != "vxcan";
}

std::unique_ptr<OperatorEnable> enable_for(const std::string& robot, bool waive_operator) {
  if (waive_operator || !is_real(robot)) {
    return std::make_unique<WaivedEnable>();
  }
  return std::make_unique<TerminalEnable>(STDIN_FILENO, stderr);
}

/// Shows how far the weld is, in a thread of its own: the cycle never waits for a terminal.
class ShownProgress {
 public:
  explicit ShownProgress(Progress& progress) : thread_([this, &progress] { show(progress); }) {}
  ~ShownProgress() {
    ended_ = true;
    thread_.join();
  }
  ShownProgress(const ShownProgress&) = delete;
  ShownProgress& operator=(const ShownProgress&) = delete;

  void set(std::size_t done, std::size_t total) {
    total_ = total;
    done_ = done;
  }

 private:
  void show(Progress& progress) {
    std::size_t shown = 0;
    for (bool last = false; !last;) {
      last = ended_;
      const std::size_t done = done_;
      if (done != shown) {
        progress.show("welding", done, total_);
        shown = done;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(last ? 0 : 100));
    }
  }

  std::atomic<std::size_t> done_{0};
  std::atomic<std::size_t> total_{0};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

void write_log(hal::candump::RecordingBus& bus, const std::filesystem::path& file) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> log(std::fopen(file.c_str(), "w"),
                                                            &std::fclose);
  if (log == nullptr || !bus.flush(log.get()).ok() || std::fflush(log.get()) != 0) {
    throw Failure(ExitCode::kUsage, "can.log: cannot be written");
  }
}

std::string fault_of(const WeldOutcome& outcome) {
  const char* arc = outcome.health.arc_on ? "arc-off was sent, and the robot did NOT confirm it"
                                          : "the robot confirmed that the arc is off";
  if (outcome.interrupted) {
    return arc;
  }
  if (outcome.released) {
    return std::string("the operator took the enable back; ") + arc;
  }
  if (outcome.fault != rt::Fault::kNone) {
    return std::string("the weld was stopped: ") + rt::name(outcome.fault);
  }
  if (outcome.health.robot_fault != rt::Fault::kNone) {
    return std::string("the robot is not ready: ") + rt::name(outcome.health.robot_fault);
  }
  return std::string("the robot did not follow: ") + link::name(outcome.health.link_fault);
}

std::string microseconds(const rt::Histogram& times) {
  char text[96];
  std::snprintf(text, sizeof(text), "99.9 %% under %u us, worst %.1f us of %llu",
                times.quantile_us(0.999), 1e-3 * static_cast<double>(times.max_ns()),
                static_cast<unsigned long long>(times.count()));
  return text;
}

void add_facts(const WeldOutcome& outcome, const RobotSide& side, const rt::CycleTimes& times,
               DriveReport& report) {
  report.facts = {{"set points sent", std::to_string(outcome.link.points_sent)},
                  {"set points sent again", std::to_string(outcome.link.points_resent)},
                  {"cycles", std::to_string(outcome.health.cycles)},
                  {"cycles overrun", std::to_string(outcome.health.overruns)},
                  {"frames sent", std::to_string(outcome.health.frames_sent)},
                  {"frames received", std::to_string(outcome.health.frames_received)}};
  if (times.compute.max_ns() > 0) {  // Virtual time stands still while it is computed.
    report.facts.emplace_back("wake-up of the cycle", microseconds(times.wake_up));
    report.facts.emplace_back("compute of the cycle", microseconds(times.compute));
  }
  const auto more = side.facts();
  report.facts.insert(report.facts.end(), more.begin(), more.end());
}

}  // namespace

void check_robot(const std::string& robot, bool waive_operator) {
  if (robot != "sim" && robot != "none" && !(robot.starts_with("can:") && robot.size() > 4)) {
    throw Failure(ExitCode::kUsage, "--robot " + robot + ": sim, can:IFACE or none is meant");
  }
  if (is_real(robot) && !waive_operator && isatty(STDIN_FILENO) == 0) {
    throw Failure(ExitCode::kUsage, "--robot " + robot +
                                        ": nobody is at a terminal to enable the weld "
                                        "(--waive-operator arms without)");
  }
}

DriveReport drive_robot(const std::string& robot, bool waive_operator,
                        const WeldRun::Config& config, MotionJob& motion,
                        const std::filesystem::path& can_log, const std::atomic<bool>& interrupted,
                        Progress& progress) {
  const auto side = open_robot(robot, config, motion);
  hal::candump::RecordingBus bus(side->bus(), side->clock(), side->interface(), kRecordedFrames);
  const auto enable = enable_for(robot, waive_operator);
  WeldRun weld(config, *side, bus, *enable, interrupted);
  WeldOutcome outcome;
  {
    ShownProgress shown(progress);
    outcome = weld.run([&](const torch::TorchPose& now) { return motion.plan_from(now); },
                       [&](std::size_t done, std::size_t total) { shown.set(done, total); });
  }
  write_log(bus, can_log);
  DriveReport report;
  report.finished = outcome.finished;
  report.fault = outcome.finished ? "" : fault_of(outcome);
  add_facts(outcome, *side, weld.times(), report);
  const auto broken = motion.broken_after(outcome.executed);
  if (!outcome.finished && broken) {
    report.facts.emplace_back("to take the bead up again", broken->resume_options());
  }
  return report;
}

}  // namespace dseam::program
