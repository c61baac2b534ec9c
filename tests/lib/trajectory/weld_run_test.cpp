// SPDX-License-Identifier: Apache-2.0
// The whole way from a seam to set points, as the main job goes it.
#include <gtest/gtest.h>

#include "dseam/torch/path_planner.hpp"
#include "dseam/torch/torch_planner.hpp"
#include "dseam/trajectory/sampler.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/analytic_saddle.hpp"

namespace {

using dseam::torch::PathPlanner;
using dseam::torch::PathPoint;
using dseam::torch::TorchPlanner;
using dseam::torch::TorchPoint;
using dseam::trajectory::LimitKind;
using dseam::trajectory::Sampler;
using dseam::trajectory::SetPoint;
using dseam::trajectory::TimeScaling;

constexpr double kDegree = std::numbers::pi / 180.0;

struct WeldRun {
  std::vector<TorchPoint> torch;
  std::vector<PathPoint> path;
  std::vector<SetPoint> set_points;
  PathPlanner::Report report;
};

WeldRun run(const dseam::test::Saddle& saddle, const PathPlanner::Config& config,
            std::uint32_t period_us) {
  constexpr std::size_t kRoom = 40000;
  dseam::test::ArenaOwner owner(TorchPlanner::bytes(1000) + TimeScaling::bytes(kRoom));
  const auto seam = saddle.points(720);
  WeldRun run;
  run.torch.resize(2000);
  run.path.resize(kRoom);
  dseam::Buffer<TorchPoint> torch(run.torch);
  dseam::Buffer<PathPoint> path(run.path);
  TorchPlanner torch_planner = TorchPlanner::make({}, 1000, owner.arena()).value();
  PathPlanner path_planner = PathPlanner::make(config).value();
  TimeScaling timing = TimeScaling::make({}, kRoom, owner.arena()).value();
  const auto planned = torch_planner.run(dseam::test::view_of(seam), torch);
  const dseam::test::AllocationCounter counter;
  run.report = path_planner.run({torch.view(), planned.length_mm, true}, path);
  EXPECT_EQ(timing.run(path.view()).state, TimeScaling::State::kTimed);
  Sampler sampler = Sampler::make(timing.timed_path(), {}, period_us).value();
  EXPECT_EQ(counter.count(), 0U);
  run.set_points.resize(sampler.size());
  dseam::Buffer<SetPoint> out(run.set_points);
  const dseam::test::AllocationCounter sampling;
  EXPECT_TRUE(sample_all(sampler, out));
  EXPECT_EQ(sampling.count(), 0U);
  run.torch.resize(torch.size());
  run.path.resize(path.size());
  return run;
}

/// The parts of the simulated seams, and a few that lean and stand aside further.
const dseam::test::Saddle kSaddles[] = {
    {100.0, 40.0, 90 * kDegree, 0.0},  {100.0, 40.0, 60 * kDegree, 0.0},
    {100.0, 40.0, 65 * kDegree, 15.0}, {108.0, 59.2, 62.9 * kDegree, 1.4},
    {60.0, 20.0, 75 * kDegree, 20.0},  {300.0, 25.0, 90 * kDegree, 0.0}};

double off_seam_mm(const dseam::test::Saddle& saddle, const Eigen::Vector3d& p_base) {
  return (p_base - saddle.at(saddle.angle_of(p_base)).p_base).norm();
}

TEST(WeldRun, the_torch_welds_once_round_and_over_the_start_at_constant_speed_on_the_seam) {
  for (const dseam::test::Saddle& saddle : kSaddles) {
    const WeldRun weld = run(saddle, {}, 1000);

    ASSERT_EQ(weld.report.state, PathPlanner::State::kPlanned);
    EXPECT_NEAR(weld.report.weld_mm, saddle.length_mm() + 10.0, 0.05);
    double welded_mm = 0.0;
    double steady_mm = 0.0;
    for (std::size_t i = 1; i < weld.set_points.size(); ++i) {
      const SetPoint& a = weld.set_points[i - 1];
      const SetPoint& b = weld.set_points[i];
      if (!a.arc || !b.arc) {
        continue;
      }
      const double step_mm = (b.pose.p_base - a.pose.p_base).norm();
      welded_mm += step_mm;
      EXPECT_LT(off_seam_mm(saddle, b.pose.p_base), 0.01);
      if (a.limited_by == LimitKind::kNone && b.limited_by == LimitKind::kNone) {
        steady_mm += step_mm;
        EXPECT_NEAR(step_mm / 1e-3, 8.0, 0.08);
      }
    }
    EXPECT_NEAR(welded_mm, weld.report.weld_mm, 0.2);
    EXPECT_GT(steady_mm, 0.95 * weld.report.weld_mm);
  }
}

double distance_to_segment(const Eigen::Vector3d& p, const PathPoint& a, const PathPoint& b) {
  const Eigen::Vector3d along = b.pose.p_base - a.pose.p_base;
  const Eigen::Vector3d from = p - a.pose.p_base;
  const double u = std::clamp(from.dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
  return (from - u * along).norm();
}

/// How far a set point lies off a path that is so fine that its points are the path.
double off_path_mm(const SetPoint& point, const std::vector<PathPoint>& path, std::size_t& near) {
  constexpr double kAroundMm = 0.3;
  while (near + 1 < path.size() && path[near].s_mm < point.s_mm - kAroundMm) {
    ++near;
  }
  double least_mm = 1e9;
  for (std::size_t i = near; i + 1 < path.size() && path[i].s_mm < point.s_mm + kAroundMm; ++i) {
    least_mm = std::min(least_mm, distance_to_segment(point.pose.p_base, path[i], path[i + 1]));
  }
  return least_mm;
}

TEST(WeldRun, a_woven_or_shifted_pass_keeps_its_path_and_its_speed_along_the_seam) {
  using dseam::torch::WeaveShape;
  PathPlanner::Config sine;
  sine.passes[0].weave = {WeaveShape::kSine, 2.0, 8.0};
  PathPlanner::Config circle;
  circle.passes[0].weave = {WeaveShape::kCircle, 1.0, 6.0};
  PathPlanner::Config dwelling;
  dwelling.passes[0].weave = {WeaveShape::kSine, 2.0, 10.0, 1.0, 0.5};
  PathPlanner::Config shifted;
  shifted.passes[0].across_mm = 3.0;
  shifted.passes[0].out_mm = 3.0;
  for (PathPlanner::Config config : {sine, circle, dwelling, shifted}) {
    const WeldRun weld = run(kSaddles[2], config, 1000);
    config.step_mm = 0.02;
    const WeldRun fine = run(kSaddles[2], config, 100'000);

    ASSERT_EQ(fine.report.state, PathPlanner::State::kPlanned);
    std::size_t near = 0;
    std::size_t steady = 0;
    for (std::size_t i = 1; i < weld.set_points.size(); ++i) {
      const SetPoint& a = weld.set_points[i - 1];
      const SetPoint& b = weld.set_points[i];
      if (!a.arc || !b.arc) {
        continue;
      }
      EXPECT_LT(off_path_mm(b, fine.path, near), 0.01) << b.s_mm;
      if (a.limited_by == LimitKind::kNone && b.limited_by == LimitKind::kNone) {
        ++steady;
        EXPECT_NEAR((b.s_mm - a.s_mm) / 1e-3, 8.0, 0.08);
      }
    }
    EXPECT_GT(steady, weld.set_points.size() / 2);
  }
}

TEST(WeldRun, at_a_hundred_hertz_the_torch_turns_by_at_most_half_a_degree_in_a_step) {
  for (const dseam::test::Saddle& saddle : kSaddles) {
    const WeldRun weld = run(saddle, {}, 10'000);

    double largest_rad = 0.0;
    double turned_rad = 0.0;
    for (std::size_t i = 1; i < weld.set_points.size(); ++i) {
      const SetPoint& a = weld.set_points[i - 1];
      const SetPoint& b = weld.set_points[i];
      const double step_rad = b.pose.q_base_torch.angularDistance(a.pose.q_base_torch);
      largest_rad = a.arc ? std::max(largest_rad, step_rad) : largest_rad;
      turned_rad += step_rad;
    }
    EXPECT_LE(largest_rad, 0.5 * kDegree);
    EXPECT_GT(turned_rad, 2.0 * std::numbers::pi);  // Once about the nozzle.
  }
}

TEST(WeldRun, starts_and_ends_at_rest_and_never_jumps) {
  const WeldRun weld = run({}, {}, 1000);

  EXPECT_EQ(weld.set_points.front().speed_mm_s, 0.0);
  EXPECT_NEAR(weld.set_points.back().speed_mm_s, 0.0, 1e-6);
  EXPECT_LT((weld.set_points.back().pose.p_base - weld.path.back().pose.p_base).norm(), 1e-6);
  for (std::size_t i = 1; i < weld.set_points.size(); ++i) {
    const SetPoint& a = weld.set_points[i - 1];
    const SetPoint& b = weld.set_points[i];
    EXPECT_EQ(b.t_us, a.t_us + 1000);
    EXPECT_LT((b.pose.p_base - a.pose.p_base).norm(), 0.2501);
  }
}

}  // namespace
