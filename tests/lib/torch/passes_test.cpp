// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "lib/torch/planned_curve.hpp"

namespace {

using dseam::test::burning;
using dseam::test::Curve;
using dseam::test::Path;
using dseam::test::plan;
using dseam::torch::PathPlanner;
using dseam::torch::PathPoint;
using dseam::torch::Segment;
using dseam::torch::TorchPoint;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(PathPlanner, a_pass_lies_where_its_offsets_say_and_turns_by_its_angle) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 2;
  config.passes[1].across_mm = 3.0;
  config.passes[1].out_mm = 4.0;
  config.passes[1].work_offset_rad = 10 * kDegree;
  config.passes[1].start_shift_mm = 30.0;
  config.passes[1].schedule = 2;

  const Path path = plan(config, curve.view());

  ASSERT_EQ(path.report.beads, 2U);
  for (const PathPoint& point : burning(path)) {
    const TorchPoint& nearest = curve.nearest(point.pose.p_base, [&](const TorchPoint& t) {
      return point.pass == 1 ? Vector3d(3.0 * t.across + 4.0 * t.out) : Vector3d::Zero().eval();
    });
    const Vector3d offset = point.pose.p_base - nearest.pose.p_base;
    EXPECT_NEAR(offset.dot(nearest.across), point.pass == 1 ? 3.0 : 0.0, 0.05);
    EXPECT_NEAR(offset.dot(nearest.out), point.pass == 1 ? 4.0 : 0.0, 0.05);
    EXPECT_EQ(point.schedule, point.pass == 1 ? 2 : 0);
    const double turned =
        point.pose.q_base_torch.angularDistance(nearest.pose.q_base_torch) / kDegree;
    EXPECT_NEAR(turned, point.pass == 1 ? 10.0 : 0.0, 1.0);
  }
}

TEST(PathPlanner, a_pass_starts_past_the_first_one_by_its_shift) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 3;
  config.start_mm = 20.0;
  config.passes[1].start_shift_mm = 30.0;
  config.passes[2].start_shift_mm = -25.0;

  const Path path = plan(config, curve.view());

  const double starts_mm[] = {20.0, 50.0, curve.length_mm - 5.0};
  const auto burnt = burning(path);
  for (std::uint8_t pass = 0; pass < 3; ++pass) {
    const auto first = std::find_if(burnt.begin(), burnt.end(),
                                    [pass](const PathPoint& p) { return p.pass == pass; });
    ASSERT_NE(first, burnt.end());
    EXPECT_NEAR(curve.nearest(first->pose.p_base).s_mm, starts_mm[pass], 0.5);
  }
}

TEST(PathPlanner, each_arc_of_the_loop_has_its_own_row_of_welding_parameters) {
  const Curve curve;
  PathPlanner::Config config;
  config.start_mm = 40.0;
  config.passes[0].schedule = 1;
  config.passes[0].crater_schedule = 2;
  config.num_sectors = 3;
  config.sectors[0] = {0.0, 1e4, 1, 0};  // Of another pass.
  config.sectors[1] = {60.0, 100.0, 0, 3};
  config.sectors[2] = {curve.length_mm - 20.0, 30.0, 0, 4};  // Over the curve's start.

  const Path path = plan(config, curve.view());

  std::array<double, 5> burnt_mm{};
  for (std::size_t i = 0; i + 1 < path.points.size(); ++i) {
    const PathPoint& point = path.points[i];
    burnt_mm[point.schedule] += point.arc ? path.points[i + 1].s_mm - point.s_mm : 0.0;
    EXPECT_EQ(point.schedule == 2, point.segment == Segment::kCrater);
  }
  EXPECT_EQ(burnt_mm[0], 0.0);
  EXPECT_NEAR(burnt_mm[3], 40.0, 1.0);
  EXPECT_NEAR(burnt_mm[4], 50.0, 1.0);
  EXPECT_NEAR(burnt_mm[1], curve.length_mm + 10.0 - 90.0, 2.0);
  for (const PathPoint& point : burning(path)) {
    const double s_mm = curve.nearest(point.pose.p_base).s_mm;
    EXPECT_TRUE(point.schedule != 3 || (s_mm > 59.0 && s_mm < 101.0)) << s_mm;
    EXPECT_TRUE(point.schedule != 4 || s_mm > curve.length_mm - 21.0 || s_mm < 31.0) << s_mm;
  }
}

TEST(PathPlanner, resumes_before_the_stop_after_a_run_up_and_in_phase) {
  const Curve curve;
  PathPlanner::Config whole;
  whole.passes[0].weave = {dseam::torch::WeaveShape::kSine, 2.0, 5.0};
  PathPlanner::Config rest = whole;
  rest.resume = {true, 0, 100.0, 10.0, 5.0};

  const Path before = plan(whole, curve.view());
  const Path after = plan(rest, curve.view());

  EXPECT_NEAR(after.report.weld_mm, before.report.weld_mm - 95.0, 1e-6);
  const auto burnt = burning(after);
  const auto all = burning(before);
  // Every point of the rest lies on the whole weave.
  for (std::size_t i = 0; i < burnt.size(); i += 50) {
    double nearest_mm = 1e9;
    for (const PathPoint& point : all) {
      nearest_mm = std::min(nearest_mm, (point.pose.p_base - burnt[i].pose.p_base).norm());
    }
    EXPECT_LT(nearest_mm, 0.2);
  }
  const auto run_up =
      std::count_if(after.points.begin(), after.points.end(), [](const PathPoint& p) {
        return p.segment == Segment::kLeadIn && p.gas && !p.arc && p.dwell_s == 0.0;
      });
  EXPECT_GT(run_up, 10);
}

TEST(PathPlanner, nothing_is_left_to_resume_after_the_last_bead) {
  PathPlanner::Config config;
  config.resume = {true, 0, 1e4, 10.0, 5.0};

  EXPECT_EQ(plan(config, Curve{}.view()).report.state, PathPlanner::State::kNothingLeft);
}

/// Turn about the wire from the first burning point on.
double greatest_turn(const Path& path) {
  double turn = 0.0;
  double most = 0.0;
  bool begun = false;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    begun = begun || path.points[i - 1].arc;
    const Eigen::Quaterniond d =
        path.points[i - 1].pose.q_base_torch.conjugate() * path.points[i].pose.q_base_torch;
    turn += begun ? 2.0 * std::atan2(d.w() < 0 ? -d.z() : d.z(), std::abs(d.w())) : 0.0;
    most = std::max(most, std::abs(turn));
  }
  return most;
}

TEST(PathPlanner, the_wrist_turns_back_between_passes_rather_than_beyond_its_limit) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 4;
  config.max_wrist_turn_rad = 300 * kDegree;

  const Path path = plan(config, curve.view());

  EXPECT_EQ(path.report.beads, 4U);
  EXPECT_LT(path.report.wrist_turn_rad, 300 * kDegree);
  EXPECT_LT(greatest_turn(path), 301 * kDegree);
  EXPECT_DOUBLE_EQ(path.report.unwound_rad, 0.0);
}

TEST(PathPlanner, a_limit_under_one_turn_is_kept_by_turning_about_the_wire) {
  const Curve curve;
  PathPlanner::Config config;
  config.num_passes = 2;
  config.max_wrist_turn_rad = 180 * kDegree;

  const Path path = plan(config, curve.view());

  EXPECT_LT(greatest_turn(path), 181 * kDegree);
  EXPECT_GT(path.report.unwound_rad, 60 * kDegree);
  for (const PathPoint& point : burning(path)) {  // The wire itself does not move.
    const TorchPoint& nearest = curve.nearest(point.pose.p_base);
    const Vector3d wire = point.pose.q_base_torch * Vector3d::UnitZ();
    const Vector3d asked = nearest.pose.q_base_torch * Vector3d::UnitZ();
    EXPECT_LT(std::acos(std::min(1.0, wire.dot(asked))), 1.0 * kDegree);
  }
}

TEST(PathPlanner, length_never_falls_and_the_torch_never_jumps) {
  PathPlanner::Config config;
  config.num_passes = 3;
  Curve curve;
  curve.block(0.4, 0.6);

  const Path path = plan(config, curve.view());

  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const double step_mm = (path.points[i].pose.p_base - path.points[i - 1].pose.p_base).norm();
    EXPECT_GE(path.points[i].s_mm, path.points[i - 1].s_mm);
    EXPECT_LT(step_mm, 6.0);
    EXPECT_LT(
        path.points[i].pose.q_base_torch.angularDistance(path.points[i - 1].pose.q_base_torch),
        0.3);
  }
}

}  // namespace
