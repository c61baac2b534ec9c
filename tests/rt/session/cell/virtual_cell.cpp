// SPDX-License-Identifier: Apache-2.0
#include "rt/session/cell/virtual_cell.hpp"

#include <algorithm>
#include <array>

#include "dseam/hal/bus/link_port.hpp"
#include "dseam/link/codec.hpp"
#include "dseam/trajectory/sampler.hpp"

namespace dseam::test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::uint16_t kRobotPoints = 512;
constexpr std::int64_t kArcOffAfterTripNs = 25 * kMs;  // The robot's silence limit and the wire.

link::Receiver make_robot(Arena& arena) {
  return link::Receiver::make({}, kRobotPoints, arena).value();
}

}  // namespace

/// 30 mm along x at 20 mm/s, the arc on over the middle 20 mm, sampled every 10 ms.
std::vector<trajectory::SetPoint> VirtualCell::weld_points() {
  std::vector<torch::PathPoint> path;
  for (int i = 0; i <= 60; ++i) {
    torch::PathPoint point;
    point.s_mm = 0.5 * i;
    point.pose.p_base.x() = point.s_mm;
    point.speed_mm_s = 20.0;
    point.arc = point.gas = i >= 10 && i < 50;
    point.segment = point.arc ? torch::Segment::kWeld : torch::Segment::kApproach;
    path.push_back(point);
  }
  ArenaOwner memory(trajectory::TimeScaling::bytes(path.size()));
  auto timing = trajectory::TimeScaling::make({}, path.size(), memory.arena()).value();
  (void)timing.run(path);
  auto sampler = trajectory::Sampler::make(timing.timed_path(), {}, 10'000).value();
  std::vector<trajectory::SetPoint> points(sampler.size());
  Buffer<trajectory::SetPoint> out(points);
  (void)sample_all(sampler, out);
  return points;
}

VirtualCell::VirtualCell(std::uint64_t seed, rt::WeldSession::Config config)
    : clock(10 * kMs),
      bus(seed),
      vision(seed, clock),
      points_(weld_points()),
      memory_(link::Receiver::bytes(kRobotPoints)),
      sender_(link::Sender::make({}).value()),
      robot_(make_robot(memory_.arena())),
      session(rt::WeldSession::make(config, sender_, bus).value()),
      random_(seed, 1) {
  inputs.real_time = true;
}

void VirtualCell::run(std::int64_t ns) {
  const std::int64_t end_ns = now_ns() + ns;
  while (now_ns() < end_ns) {
    cycle();
  }
}

void VirtualCell::cycle() {
  bus.sent_this_cycle.clear();
  const std::int64_t end_ns = now_ns() + kPeriodNs + stall_ns;
  while (now_ns() + kPeriodNs < end_ns) {  // While the host stalls the others live on.
    clock.advance(kPeriodNs);
    robot_cycle();
    vision.step();
  }
  clock.advance(kPeriodNs);
  const bool host_first = random_.below(4) == 0;
  if (host_first) {
    host_cycle();
  }
  robot_cycle();
  vision.step();
  if (!host_first) {
    host_cycle();
  }
  check();
}

void VirtualCell::host_cycle() {
  bus.advance(now_ns());
  inputs.tick.due_ns = now_ns();
  inputs.tick.woke_ns = now_ns() + random_.below(50'000);
  inputs.tick.skipped = static_cast<std::uint64_t>(stall_ns / kPeriodNs);
  inputs.tick.gap = stall_ns > 50 * kMs;
  stall_ns = 0;
  vision.tell(inputs);
  session.step(inputs);
}

void VirtualCell::robot_cycle() {
  bus.advance(now_ns());
  hal::CanFrame frame;
  while (bus.robot_receive(frame)) {
    robot_.on_frame(hal::to_link(frame), now_ns());
  }
  std::array<link::Frame, 16> storage{};
  Buffer<link::Frame> out(storage);
  const bool moving = robot_.moving();
  robot_.report_condition(robot_trouble.condition);
  robot_.poll(now_ns(), out);
  move_robot();
  arc_on_ns_ += robot_.arc_on() ? kPeriodNs : 0;
  if (robot_.arc_on() && !moving && !robot_.moving()) {
    broke("motion stopped, arc on");
  }
  speak(out);
}

void VirtualCell::move_robot() {
  link::DuePoint due;
  while (robot_.take_due(due)) {
    if (due.trajectory != trajectory_) {
      trajectory_ = due.trajectory;
      executed_ = 0;
    }
    if (due.index != executed_) {
      broke("a set point was lost, doubled or reordered");
    }
    const auto& asked = points_[std::min(executed_, points_.size() - 1)];
    const double off_mm = (due.point.pose.p_base - asked.pose.p_base).norm();
    if (due.point.t_us != asked.t_us || off_mm > 0.002 || due.point.arc != asked.arc) {
      broke("the robot executed another point than was planned");
    }
    ++executed_;
    robot_pose_ = due.point.pose;
    robot_speed_mm_s_ = due.point.speed_mm_s;
  }
  const double rate = static_cast<double>(robot_.path_ns() - path_before_ns_) / kPeriodNs;
  path_before_ns_ = robot_.path_ns();
  if (!robot_trouble.frozen) {
    torch::TorchPose pose = robot_pose_;
    pose.p_base += Eigen::Vector3d(-robot_trouble.behind_mm, robot_trouble.aside_mm, 0.0);
    robot_.report_pose(pose,
                       robot_speed_mm_s_ * std::clamp(rate, 0.0, 1.0) * robot_trouble.speed_factor);
  }
}

void VirtualCell::speak(const Buffer<link::Frame>& frames) {
  if (robot_trouble.impostor) {
    std::array<link::Frame, 2> storage{};
    Buffer<link::Frame> out(storage);
    robot_trouble.impostor->robot_time_us = static_cast<std::uint64_t>(now_ns() / 1000);
    (void)impostor_.send(link::MessageId::kStatus, link::encode(*robot_trouble.impostor), out);
    bus.robot_send(hal::to_can(out[0]));
    return;
  }
  for (const link::Frame& frame : frames.view()) {
    if (!robot_trouble.silent) {
      bus.robot_send(hal::to_can(frame));
    }
  }
}

void VirtualCell::broke(const char* what) {
  if (breach_.empty()) {
    breach_ = std::string(what) + " at " + std::to_string(now_ns() / 1000) + " us in " +
              rt::name(session.state()) + ", fault " + rt::name(session.fault());
  }
}

/// What holds after every cycle, whatever was injected.
void VirtualCell::check() {
  const rt::Fault fault = session.fault();
  const bool new_fault = fault != rt::Fault::kNone && fault_before_ == rt::Fault::kNone;
  const bool blocked = bus.trouble.blocked || bus.trouble.state >= hal::BusState::kBusOff;
  const std::uint32_t abort_id = link::Addressing{}.id_of(link::MessageId::kAbort);
  const std::uint32_t point_id = link::Addressing{}.id_of(link::MessageId::kPoint);
  if (static_cast<std::uint8_t>(session.state()) >= rt::kNumSessionStates) {
    broke("a state outside the table");
  }
  if (new_fault && armed_before_ && !blocked &&
      (bus.sent_this_cycle.empty() || bus.sent_this_cycle.front().id != abort_id)) {
    broke("arc-off was not the first frame of the cycle that found the fault");
  }
  if (fault != rt::Fault::kNone) {
    if (session.health().arc_permitted) {
      broke("a permit in spite of a fault");
    }
    for (const hal::CanFrame& frame : bus.sent_this_cycle) {
      if (frame.id == point_id) {
        broke("a set point was sent in spite of a fault");
      }
    }
  }
  if (new_fault) {
    tripped_ns_ = now_ns();
  }
  if (fault != rt::Fault::kNone && robot_.arc_on() && now_ns() - tripped_ns_ > kArcOffAfterTripNs) {
    broke("the arc burnt on after the fault");
  }
  fault_before_ = fault;
  armed_before_ = sender_.armed();
  mix(static_cast<std::uint64_t>(session.state()) | static_cast<std::uint64_t>(fault) << 8U |
      static_cast<std::uint64_t>(robot_.state()) << 16U | (robot_.arc_on() ? 1ULL << 24U : 0U) |
      static_cast<std::uint64_t>(bus.sent_this_cycle.size()) << 32U);
  for (const hal::CanFrame& frame : bus.sent_this_cycle) {
    mix(frame.id | static_cast<std::uint64_t>(frame.data[0]) << 32U |
        static_cast<std::uint64_t>(frame.data[1]) << 40U);
  }
}

bool VirtualCell::bring_to(rt::SessionState wanted) {
  using S = rt::SessionState;
  using E = rt::SessionEvent;
  const auto at = [&](S s) { return session.state() == s; };
  if (at(S::kIdle)) {
    (void)session.order(E::kScan);
  }
  if (wanted == S::kScanned) {
    return at(S::kScanned);
  }
  if (at(S::kScanned)) {
    robot_pose_ = points_.front().pose;  // Somebody drove it back by hand.
    robot_speed_mm_s_ = 0.0;
    (void)session.plan(robot_pose_, points_);
    inputs.operator_enable = false;
    (void)session.connect(new_session(), now_ns());
    (void)run_until([&] { return sender_.state() == link::HostState::kIdle; }, 1000 * kMs);
  }
  if (wanted == S::kPlanned) {
    return at(S::kPlanned);
  }
  // Nobody enables the weld before the camera sees the seam again.
  const auto sees = [&] {
    return inputs.vision_silent_ns < 100 * kMs && inputs.confidence == seam::Confidence::kHigh;
  };
  (void)run_until(sees, 1000 * kMs);
  inputs.operator_enable = true;
  cycle();
  (void)session.order(E::kArm);
  (void)run_until([&] { return sender_.state() == link::HostState::kArmed; }, 500 * kMs);
  if (wanted == S::kArmed) {
    return at(S::kArmed);
  }
  (void)session.order(E::kLoad);
  (void)run_until([&] { return sender_.state() == link::HostState::kReady; }, 1000 * kMs);
  if (wanted == S::kLoading) {
    return at(S::kLoading);
  }
  (void)session.order(E::kStart);
  (void)run_until([&] { return sender_.state() == link::HostState::kRunning; }, 500 * kMs);
  return at(S::kRunning);
}

}  // namespace dseam::test
