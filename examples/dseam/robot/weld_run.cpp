// SPDX-License-Identifier: Apache-2.0
#include "robot/weld_run.hpp"

#include <random>

#include "failure.hpp"

namespace dseam::program {
namespace {

constexpr double kAnswerLimitS = 3.0;
constexpr double kOperatorLimitS = 600.0;

link::Sender sender_of(const link::Sender::Config& config) {
  auto sender = link::Sender::make(config);
  if (!sender.ok()) {
    throw Failure(ExitCode::kUsage, "the configured weld link: a limit is out of range");
  }
  return sender.value();
}

rt::WeldSession session_of(const WeldRun::Config& config, link::Sender& sender, hal::CanBus& bus) {
  rt::WeldSession::Config gated = config.session;
  gated.arc.workspace = gated.motion.workspace = config.workspace;
  gated.arc.max_standing_ns = static_cast<std::int64_t>(1e9 * config.max_standing_s);
  auto session = rt::WeldSession::make(gated, sender, bus);
  if (!session.ok()) {
    throw Failure(ExitCode::kUsage, "the configured weld session: a limit is out of range");
  }
  return session.value();
}

/// Never 0, and never used before as far as chance allows.
std::uint32_t new_session() { return std::random_device()() | 1U; }

}  // namespace

WeldRun::WeldRun(const Config& config, RobotSide& side, hal::CanBus& bus, OperatorEnable& enable,
                 const std::atomic<bool>& interrupted)
    : side_(side),
      enable_(enable),
      interrupted_(interrupted),
      sender_(sender_of(config.link)),
      session_(session_of(config, sender_, bus)) {
  inputs_.real_time = side.real_time();
}

WeldOutcome WeldRun::run(const Planner& plan, const Progress& progress) {
  WeldOutcome outcome;
  (void)session_.connect(new_session(), side_.clock().now_ns());
  const auto greeted = [this] {
    return sender_.state() == link::HostState::kIdle && sender_.pose().robot_time_us > 0;
  };
  if (cycle_until(greeted, kAnswerLimitS) && wait_for_operator()) {
    const trajectory::SetPointView points = plan(sender_.pose().pose);
    outcome.finished = !points.empty() && start(points) && follow(points.size(), progress);
  }
  end_in_order();
  outcome.interrupted = interrupted_;
  outcome.released = released_;
  outcome.fault = session_.fault();
  outcome.executed = sender_.executed();
  outcome.health = session_.health();
  outcome.link = sender_.report();
  return outcome;
}

/// The enable must come as an edge, and be there when the session arms.
bool WeldRun::wait_for_operator() {
  enable_.ask();
  return cycle_until([this] { return inputs_.operator_enable; }, kOperatorLimitS);
}

bool WeldRun::start(trajectory::SetPointView points) {
  using E = rt::SessionEvent;
  using H = link::HostState;
  const auto link_is = [this](H state) {
    return [this, state] { return sender_.state() == state; };
  };
  if (!session_.order(E::kScan).ok() || !session_.plan(sender_.pose().pose, points).ok()) {
    return false;
  }
  cycle();  // Late by the time that planning took: nothing is armed yet that it could trip.
  return session_.order(E::kArm).ok() && cycle_until(link_is(H::kArmed), kAnswerLimitS) &&
         session_.order(E::kLoad).ok() && cycle_until(link_is(H::kReady), kAnswerLimitS) &&
         session_.order(E::kStart).ok() && cycle_until(link_is(H::kRunning), kAnswerLimitS);
}

bool WeldRun::follow(std::size_t total, const Progress& progress) {
  // The session stops the link by itself after the last point, and is idle once the robot stands.
  for (std::size_t cycles = 0; session_.state() != rt::SessionState::kIdle; ++cycles) {
    if (stopped()) {
      return false;
    }
    if (cycles % 250 == 0) {
      progress(sender_.executed(), total);
    }
    cycle();
  }
  progress(total, total);
  return true;
}

bool WeldRun::cycle_until(const std::function<bool()>& done, double limit_s) {
  const std::int64_t end_ns = side_.clock().now_ns() + static_cast<std::int64_t>(limit_s * 1e9);
  while (!done()) {
    if (stopped() || side_.clock().now_ns() > end_ns) {
      return false;
    }
    cycle();
  }
  return true;
}

void WeldRun::cycle() {
  inputs_.tick = side_.next_cycle();
  if (interrupted_) {
    session_.trip(rt::Fault::kOperator);  // The abort leaves with this very cycle.
  }
  const bool held = enable_.held() && !ending_;
  released_ = released_ || (inputs_.operator_enable && !held && !ending_);
  inputs_.operator_enable = held;
  session_.step(inputs_);
  times_.wake_up.add(inputs_.tick.woke_ns - inputs_.tick.due_ns);
  times_.compute.add(side_.clock().now_ns() - inputs_.tick.woke_ns);
}

/// Until the robot stands with the arc off, or half a second has passed.
void WeldRun::end_in_order() {
  ending_ = true;
  const std::int64_t end_ns = side_.clock().now_ns() + 500'000'000;
  do {
    cycle();
  } while (side_.clock().now_ns() < end_ns &&
           (sender_.status().arc_on || session_.state() == rt::SessionState::kFault ||
            session_.state() == rt::SessionState::kStopping));
}

bool WeldRun::stopped() const {
  return interrupted_ || released_ || session_.fault() != rt::Fault::kNone;
}

}  // namespace dseam::program
