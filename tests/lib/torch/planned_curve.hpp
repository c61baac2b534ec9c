// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dseam/torch/path_planner.hpp"
#include "dseam/torch/torch_planner.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/analytic_saddle.hpp"

namespace dseam::test {

/// A torch curve over a saddle, planned once.
struct Curve {
  std::vector<torch::TorchPoint> points;
  double length_mm = 0.0;
  bool closed = true;

  explicit Curve(const Saddle& saddle = {}) : points(2000) {
    ArenaOwner owner(torch::TorchPlanner::bytes(1000));
    const auto seam = saddle.points(720);
    Buffer<torch::TorchPoint> out(points);
    length_mm = torch::TorchPlanner::make({}, 1000, owner.arena())
                    .value()
                    .run(view_of(seam), out)
                    .length_mm;
    points.resize(out.size());
  }
  [[nodiscard]] torch::TorchCurveView view() const { return {points, length_mm, closed}; }
  /// The points between two shares of the way round are not weldable.
  void block(double from, double to) {
    for (torch::TorchPoint& point : points) {
      if (point.s_mm >= from * length_mm && point.s_mm < to * length_mm) {
        point.weldable = torch::Weldable::kInterpolated;
      }
    }
  }
  /// The point whose place, moved by `offset` of it, is the nearest to `p_base`.
  template <typename Offset>
  [[nodiscard]] const torch::TorchPoint& nearest(const Eigen::Vector3d& p_base,
                                                 Offset offset) const {
    const auto far = [&](const torch::TorchPoint& t) {
      return (t.pose.p_base + offset(t) - p_base).norm();
    };
    return *std::min_element(points.begin(), points.end(),
                             [&](const auto& a, const auto& b) { return far(a) < far(b); });
  }
  [[nodiscard]] const torch::TorchPoint& nearest(const Eigen::Vector3d& p_base) const {
    return nearest(p_base, [](const torch::TorchPoint&) { return Eigen::Vector3d::Zero().eval(); });
  }
};

struct Path {
  torch::PathPlanner::Report report;
  std::vector<torch::PathPoint> points;
};

inline Path plan(const torch::PathPlanner::Config& config, const torch::TorchCurveView& curve,
                 const torch::TorchPose* now = nullptr, std::size_t room = 40'000) {
  torch::PathPlanner planner = torch::PathPlanner::make(config).value();
  std::vector<torch::PathPoint> storage(room);
  Buffer<torch::PathPoint> out(storage);
  const AllocationCounter counter;
  Path path{now == nullptr ? planner.run(curve, out) : planner.run_from(*now, curve, out), {}};
  EXPECT_EQ(counter.count(), 0U);
  path.points.assign(out.view().begin(), out.view().end());
  return path;
}

inline std::vector<torch::PathPoint> burning(const Path& path) {
  std::vector<torch::PathPoint> points;
  std::copy_if(path.points.begin(), path.points.end(), std::back_inserter(points),
               [](const torch::PathPoint& p) { return p.arc && p.dwell_s == 0.0; });
  return points;
}

}  // namespace dseam::test
