// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hal/sim_robot/cell.hpp"

namespace dseam::test {

/// Points whose every field follows from their place and session, so that any mix-up shows.
inline std::vector<trajectory::SetPoint> marked_points(std::size_t count, std::uint32_t session) {
  std::vector<trajectory::SetPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i].t_us = static_cast<std::uint32_t>(i) * 2000;
    points[i].pose.p_base = {static_cast<double>(session), static_cast<double>(i) * 0.001, 1.0};
    points[i].speed_mm_s = 0.5;
    points[i].s_mm = static_cast<double>(i) * 0.001;
    points[i].arc = true;
  }
  return points;
}

struct Tally {
  std::uint64_t executed = 0;
  std::uint64_t wrong = 0;    ///< Lost, doubled, out of order, or not what was sent.
  std::uint64_t foreign = 0;  ///< Of another session than the one that runs.
  std::uint64_t done = 0;
  std::uint64_t tripped = 0;
};

/// One weld from HELLO to its end, whatever that is; what the robot executed is compared.
inline void weld_once(LinkCell& cell, std::uint32_t session, std::size_t count, Tally& tally) {
  const auto points = marked_points(count, session);
  const std::size_t before = cell.robot_.executed().size();
  (void)cell.sender_.connect(session, cell.clock_.now_ns());
  const auto end = cell.run({session, 1, points, true}, 2 * static_cast<int>(count) + 5000);
  (void)cell.sender_.stop(cell.clock_.now_ns());
  for (int i = 0; i < 300; ++i) {  // A stop takes 200 ms.
    cell.step_without_orders();
  }
  tally.done += end == link::WeldProgress::kDone ? 1U : 0U;
  tally.tripped += end == link::WeldProgress::kFailed ? 1U : 0U;
  const auto executed = cell.robot_.executed().subspan(before);
  for (std::size_t i = 0; i < executed.size(); ++i) {
    const link::DuePoint& due = executed[i].due;
    const bool right = due.index == i && i < count && due.point.t_us == points[i].t_us &&
                       (due.point.pose.p_base - points[i].pose.p_base).norm() < 1e-6;
    tally.wrong += right ? 0U : 1U;
    tally.foreign += due.session == session ? 0U : 1U;
  }
  tally.wrong += end == link::WeldProgress::kDone && executed.size() != count ? 1U : 0U;
  tally.executed += executed.size();
}

inline hal::sim::SimBus::Config seeded(std::uint64_t seed) {
  hal::sim::SimBus::Config config;
  config.seed = seed;
  return config;
}

inline hal::sim::SimRobot::Config recording(std::size_t points) {
  hal::sim::SimRobot::Config config;
  config.record_points = points;
  return config;
}

/// Loss, doubling, delay with overtaking and flipped bits so often; noise, short frames, old frames
/// and foreign identifiers so often.
inline hal::sim::BusFaults faults_of_every_kind(double often, double seldom) {
  hal::sim::BusFaults faults;
  faults.lost = faults.duplicated = faults.delayed = faults.flipped = often;
  faults.garbage = faults.truncated = faults.stuck = faults.wrong = seldom;
  return faults;
}

}  // namespace dseam::test
