// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/sim_robot.hpp"

#include <algorithm>

namespace dseam::hal::sim {

Result<> SimRobot::check(const Config& config) noexcept {
  std::vector<std::byte> memory(link::Receiver::bytes(config.buffer_points));
  Arena arena(memory);
  const auto receiver = link::Receiver::make(config.receiver, config.buffer_points, arena);
  return receiver.ok() ? Result<>() : receiver.error();
}

SimRobot::SimRobot(const Config& config, CanBus& bus)
    : memory_(link::Receiver::bytes(config.buffer_points)),
      arena_(memory_),
      receiver_(link::Receiver::make(config.receiver, config.buffer_points, arena_).value()),
      port_(bus),
      pose_(config.home) {
  executed_.reserve(config.record_points);
  report_condition(config.condition);
}

void SimRobot::step(std::int64_t now_ns) noexcept {
  receiver_.report_pose(pose_, last_.speed_mm_s);
  port_.turn(receiver_, now_ns);
  execute(now_ns);
  move();
}

void SimRobot::execute(std::int64_t now_ns) noexcept {
  for (link::DuePoint due; receiver_.take_due(due);) {
    last_ = due.point;
    pose_ = due.point.pose;
    if (executed_.size() < executed_.capacity()) {
      executed_.push_back({due, now_ns});
    } else {
      ++not_recorded_;
    }
  }
}

/// On a straight line, and about one axis, towards the next point.
void SimRobot::move() noexcept {
  const trajectory::SetPoint* next = receiver_.points().front();
  const bool between = next != nullptr && receiver_.points().executed() > 0;
  if (!between || next->t_us <= last_.t_us) {
    return;
  }
  const double path_us = static_cast<double>(receiver_.path_ns()) / 1000.0;
  const double part = std::clamp((path_us - last_.t_us) / (next->t_us - last_.t_us), 0.0, 1.0);
  pose_.p_base = last_.pose.p_base + part * (next->pose.p_base - last_.pose.p_base);
  pose_.q_base_torch = last_.pose.q_base_torch.slerp(part, next->pose.q_base_torch);
}

void serve(SimRobot& robot, Clock& clock, std::int64_t period_ns, const std::atomic<bool>& stop) {
  std::int64_t next_ns = clock.now_ns();
  while (!stop.load(std::memory_order_relaxed)) {
    robot.step(clock.now_ns());
    next_ns = std::max(next_ns + period_ns, clock.now_ns());
    clock.sleep_until(next_ns);
  }
}

}  // namespace dseam::hal::sim
