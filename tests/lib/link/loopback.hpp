// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "dseam/link/receiver.hpp"
#include "dseam/link/sender.hpp"
#include "support/arena_owner.hpp"

namespace dseam::link {

inline constexpr std::int64_t kStepNs = 1'000'000;

inline std::vector<trajectory::SetPoint> straight_weld(std::size_t count, std::uint32_t period_us) {
  std::vector<trajectory::SetPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i].t_us = static_cast<std::uint32_t>(i) * period_us;
    points[i].pose.p_base = {0.05 * static_cast<double>(i), 1.0, 2.0};
    points[i].speed_mm_s = 5.0;
    points[i].segment = torch::Segment::kWeld;
    points[i].arc = i > 10 && i + 10 < count;
  }
  return points;
}

/// Both ends and a cable that may be cut in either direction, in virtual time.
class LoopbackCell {
 protected:
  void rebuild() {
    host_ = Sender::make(host_config_).value();
    robot_ = Receiver::make(robot_config_, 256, arena_.arena()).value();
    executed_.reserve(10'000);
  }

  void step() {
    now_ns_ += kStepNs;
    frames_.clear();
    host_.poll(now_ns_, frames_);
    for (const Frame& frame : frames_.view()) {
      Frame carried = frame;
      if (host_to_robot_ && (on_the_way_ == nullptr || on_the_way_(carried))) {
        robot_.on_frame(carried, now_ns_);
      }
    }
    frames_.clear();
    robot_.poll(now_ns_, frames_);
    for (DuePoint due; robot_.take_due(due);) {
      executed_.push_back(due);
    }
    for (const Frame& frame : frames_.view()) {
      if (robot_to_host_) {
        host_.on_frame(frame, now_ns_);
      }
    }
  }

  bool run_until(HostState state, int most_steps = 5000) {
    for (int i = 0; i < most_steps && host_.state() != state; ++i) {
      step();
    }
    return host_.state() == state;
  }

  /// As far as kReady with `points` loaded.
  bool prepare(trajectory::SetPointView points, std::uint32_t session = 77) {
    return host_.connect(session, now_ns_).ok() && run_until(HostState::kIdle) &&
           host_.arm(now_ns_).ok() && run_until(HostState::kArmed) &&
           host_.load(points, 1, now_ns_).ok() && run_until(HostState::kReady);
  }

  bool prepare_and_start(trajectory::SetPointView points) {
    if (!prepare(points)) {
      return false;
    }
    host_.permit_weld(true);
    return host_.start(now_ns_).ok() && run_until(HostState::kRunning);
  }

  test::ArenaOwner arena_{1 << 20};
  std::vector<Frame> storage_ = std::vector<Frame>(128);
  Buffer<Frame> frames_{storage_};
  Sender::Config host_config_;
  Receiver::Config robot_config_;
  Sender host_ = Sender::make({}).value();
  Receiver robot_ = Receiver::make({}, 256, arena_.arena()).value();
  std::vector<DuePoint> executed_;
  std::int64_t now_ns_ = 1'000'000'000;
  bool host_to_robot_ = true;
  bool robot_to_host_ = true;
  /// Sees, and may spoil, each frame to the robot; false loses it.
  std::function<bool(Frame&)> on_the_way_;
  std::vector<trajectory::SetPoint> straight_ = straight_weld(1500, 4000);
};

}  // namespace dseam::link
