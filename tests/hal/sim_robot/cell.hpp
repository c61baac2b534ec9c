// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "dseam/hal/bus/link_port.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/link/weld_order.hpp"

namespace dseam::test {

/// `count` points on a circle, the arc on between the first and the last ten.
inline std::vector<trajectory::SetPoint> round_weld(std::size_t count, std::uint32_t period_us) {
  std::vector<trajectory::SetPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2e-3 * static_cast<double>(i);
    points[i].t_us = static_cast<std::uint32_t>(i) * period_us;
    points[i].pose.p_base = {80.0 * std::cos(angle), 80.0 * std::sin(angle), 300.0};
    points[i].s_mm = 80.0 * angle;
    points[i].speed_mm_s = 40.0;
    points[i].segment = torch::Segment::kWeld;
    points[i].arc = i > 10 && i + 10 < count;
  }
  return points;
}

/// Carries every frame of each bus to the other.
class Gateway {
 public:
  Gateway(hal::CanBus& a, hal::CanBus& b) : a_(a), b_(b) {}

  void carry() {
    carry(a_, b_);
    carry(b_, a_);
  }

 private:
  static void carry(hal::CanBus& from, hal::CanBus& to) {
    using namespace std::chrono_literals;
    for (auto frame = from.receive(0ns); frame.ok(); frame = from.receive(0ns)) {
      (void)to.send(frame.value());
    }
  }

  hal::CanBus& a_;
  hal::CanBus& b_;
};

/// Host, bus and robot in virtual time, one millisecond a step.
class LinkCell {
 public:
  static constexpr std::int64_t kStepNs = 1'000'000;

  explicit LinkCell(const hal::sim::SimBus::Config& bus = {},
                    const link::Sender::Config& sender = {},
                    const hal::sim::SimRobot::Config& robot = {})
      : bus_(bus, clock_),
        host_end_(bus_.connect()),
        robot_(robot, bus_.connect()),
        port_(host_end_),
        sender_(link::Sender::make(sender).value()) {}
  /// The robot on a bus of its own, which a gateway's end joins to the simulated one.
  LinkCell(hal::CanBus& robots_end, hal::CanBus& gateways_end, const hal::sim::SimBus::Config& bus,
           const hal::sim::SimRobot::Config& robot)
      : bus_(bus, clock_),
        host_end_(bus_.connect()),
        gateway_(std::in_place, bus_.connect(), gateways_end),
        robot_(robot, robots_end),
        port_(host_end_),
        sender_(link::Sender::make({}).value()) {}

  link::WeldProgress step(const link::WeldOrder& weld) {
    const link::WeldProgress progress = link::give_next_order(sender_, weld, clock_.now_ns());
    step_without_orders();
    return progress;
  }
  void step_without_orders() {
    clock_.advance(kStepNs);
    port_.turn(sender_, clock_.now_ns());
    if (gateway_) {
      gateway_->carry();
    }
    robot_.step(clock_.now_ns());
  }
  link::WeldProgress run(const link::WeldOrder& weld, int most_steps) {
    link::WeldProgress progress = link::WeldProgress::kUnderWay;
    for (int i = 0; i < most_steps && progress == link::WeldProgress::kUnderWay; ++i) {
      progress = step(weld);
    }
    return progress;
  }

  hal::fake::ManualClock clock_{1'000'000'000};
  hal::sim::SimBus bus_;
  hal::CanBus& host_end_;
  std::optional<Gateway> gateway_;
  hal::sim::SimRobot robot_;
  hal::LinkPort port_;
  link::Sender sender_;
};

}  // namespace dseam::test
