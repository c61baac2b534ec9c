// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lib/torch/planned_curve.hpp"

namespace {

using dseam::test::burning;
using dseam::test::Curve;
using dseam::test::Path;
using dseam::test::plan;
using dseam::test::Saddle;
using dseam::torch::PathPlanner;
using dseam::torch::PathPoint;
using dseam::torch::Segment;
using dseam::torch::TorchPoint;
using dseam::torch::TorchPose;
using dseam::torch::Weldable;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Travel between path points that burn.
double burnt_mm(const Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    sum += path.points[i - 1].arc ? path.points[i].s_mm - path.points[i - 1].s_mm : 0.0;
  }
  return sum;
}

TEST(PathPlanner, lays_every_segment_once_and_in_order) {
  const Curve curve;

  const Path path = plan({}, curve.view());

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  std::vector<Segment> order;
  for (const PathPoint& point : path.points) {
    if (order.empty() || order.back() != point.segment) {
      order.push_back(point.segment);
    }
  }
  EXPECT_EQ(order, (std::vector<Segment>{Segment::kApproach, Segment::kLeadIn, Segment::kWeld,
                                         Segment::kOverlap, Segment::kCrater, Segment::kLeadOut,
                                         Segment::kRetract}));
}

TEST(PathPlanner, comes_and_goes_along_the_wire_from_the_height_asked_for_slowly_at_the_end) {
  const Curve curve;
  PathPlanner::Config config;
  config.approach_mm = 60.0;
  config.lead_in_mm = 8.0;

  const Path path = plan(config, curve.view());

  const auto height_mm = [](const PathPoint& p, const PathPoint& bead) {
    const Vector3d up = -(bead.pose.q_base_torch * Vector3d::UnitZ());
    const Vector3d off = p.pose.p_base - bead.pose.p_base;
    EXPECT_NEAR(off.norm(), off.dot(up), 1e-6);  // Along the wire and nowhere else.
    return off.dot(up);
  };
  const auto burnt = burning(path);
  EXPECT_NEAR(height_mm(path.points.front(), burnt.front()), 60.0, 1e-9);
  const auto crater = std::find_if(path.points.begin(), path.points.end(), [](const PathPoint& p) {
    return p.segment == Segment::kCrater;
  });
  ASSERT_NE(crater, path.points.end());
  EXPECT_NEAR(height_mm(path.points.back(), *crater), 60.0, 1e-9);
  for (const PathPoint& point : path.points) {
    if (point.segment == Segment::kLeadIn) {
      EXPECT_LE(height_mm(point, burnt.front()), 8.0 + 1e-9);
      EXPECT_EQ(point.speed_mm_s, 20.0);
    }
    EXPECT_TRUE(point.segment != Segment::kApproach || point.speed_mm_s == 100.0);
  }
}

TEST(PathPlanner, the_overlap_passes_the_start_by_the_length_or_the_angle_asked_for) {
  const Curve curve;
  PathPlanner::Config by_angle;
  by_angle.overlap_rad = 20 * kDegree;

  EXPECT_NEAR(burnt_mm(plan({}, curve.view())), curve.length_mm + 10.0, 1e-3 * curve.length_mm);
  EXPECT_NEAR(burnt_mm(plan(by_angle, curve.view())), curve.length_mm * (1.0 + 20.0 / 360.0),
              1e-3 * curve.length_mm);
}

TEST(PathPlanner, the_weld_begins_where_it_was_asked_to) {
  const Curve curve;
  PathPlanner::Config config;
  config.start_mm = 0.25 * curve.length_mm;

  const Path path = plan(config, curve.view());

  const Vector3d begin = burning(path).front().pose.p_base;
  const Vector3d asked = curve.points[curve.points.size() / 4].pose.p_base;
  EXPECT_LT((begin - asked).norm(), 1.0);
}

TEST(PathPlanner, gas_flows_before_and_after_the_arc_and_the_wire_with_it) {
  const Path path = plan({}, Curve{}.view());

  const auto first_arc = std::find_if(path.points.begin(), path.points.end(),
                                      [](const PathPoint& p) { return p.arc; });
  const auto before = std::prev(first_arc);
  EXPECT_TRUE(before->gas && !before->wire && before->stop);
  EXPECT_DOUBLE_EQ(before->dwell_s, 0.3);
  EXPECT_DOUBLE_EQ(first_arc->dwell_s, 0.2);
  const auto crater = std::find_if(path.points.begin(), path.points.end(), [](const PathPoint& p) {
    return p.segment == Segment::kCrater;
  });
  EXPECT_TRUE(crater->arc && crater->stop);
  EXPECT_DOUBLE_EQ(crater->dwell_s, 0.5);
  EXPECT_TRUE(std::next(crater)->gas && !std::next(crater)->arc);
  EXPECT_DOUBLE_EQ(std::next(crater)->dwell_s, 0.5);
  for (const PathPoint& point : path.points) {
    EXPECT_EQ(point.arc, point.wire);
    EXPECT_TRUE(point.gas || !point.arc);
  }
}

TEST(PathPlanner, begins_where_the_torch_is) {
  const Curve curve;
  TorchPose now;
  now.p_base = Vector3d(200.0, -100.0, 300.0);
  now.q_base_torch = Eigen::AngleAxisd(2.5, Vector3d(1.0, 1.0, 0.0).normalized());

  const Path path = plan({}, curve.view(), &now);

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  EXPECT_LT((path.points.front().pose.p_base - now.p_base).norm(), 1e-9);
  EXPECT_LT(path.points.front().pose.q_base_torch.angularDistance(now.q_base_torch), 1e-9);
}

TEST(PathPlanner, a_start_pose_far_away_or_none_is_refused) {
  const Curve curve;
  TorchPose far;
  far.p_base.x() = 5000.0;
  TorchPose nowhere;
  nowhere.p_base.x() = kNan;
  TorchPose crooked;
  crooked.q_base_torch.coeffs().setZero();

  for (const TorchPose& pose : {far, nowhere, crooked}) {
    const Path path = plan({}, curve.view(), &pose);
    EXPECT_EQ(path.report.state, PathPlanner::State::kStartTooFar);
    EXPECT_TRUE(path.points.empty());
  }
}

TEST(PathPlanner, passes_by_what_is_not_weldable_with_the_arc_off_and_lifted) {
  Curve curve;
  curve.block(0.3, 0.45);
  curve.block(0.7, 0.8);

  const Path path = plan({}, curve.view());

  ASSERT_EQ(path.report.state, PathPlanner::State::kPlanned);
  EXPECT_EQ(path.report.beads, 3U);
  EXPECT_NEAR(burnt_mm(path), 0.75 * curve.length_mm + 10.0, 4.0);
  EXPECT_NEAR(path.report.skipped_mm, 0.25 * curve.length_mm, 4.0);
  for (const PathPoint& point : path.points) {
    const TorchPoint& nearest = curve.nearest(point.pose.p_base);
    if (nearest.weldable != Weldable::kYes) {
      EXPECT_FALSE(point.arc && (nearest.pose.p_base - point.pose.p_base).norm() < 0.1 &&
                   nearest.s_mm > 0.31 * curve.length_mm && nearest.s_mm < 0.44 * curve.length_mm);
    }
  }
}

TEST(PathPlanner, in_the_air_the_torch_goes_round_the_nozzle_and_not_through_it) {
  const Saddle saddle{100.0, 40.0, 90 * kDegree, 0.0};
  Curve curve(saddle);
  curve.block(0.2, 0.8);

  const Path path = plan({}, curve.view());

  for (const PathPoint& point : path.points) {
    const Vector3d& p = point.pose.p_base;
    EXPECT_GT(std::hypot(p.x(), p.y()), saddle.nozzle_mm - 0.1);
  }
}

TEST(PathPlanner, nothing_weldable_no_curve_and_a_full_buffer_have_names) {
  Curve blocked;
  blocked.block(-1.0, 2.0);
  const Curve good;

  EXPECT_EQ(plan({}, blocked.view()).report.state, PathPlanner::State::kNothingWeldable);
  EXPECT_EQ(plan({}, {}).report.state, PathPlanner::State::kNoCurve);
  const Path full = plan({}, good.view(), nullptr, 300);
  EXPECT_EQ(full.report.state, PathPlanner::State::kFull);
  EXPECT_TRUE(full.points.empty());
}

TEST(PathPlanner, values_out_of_range_are_refused) {
  const auto refused = [](auto set) {
    PathPlanner::Config config;
    set(config);
    return !PathPlanner::make(config).ok();
  };

  EXPECT_TRUE(refused([](auto& c) { c.num_passes = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.num_passes = 9; }));
  EXPECT_TRUE(refused([](auto& c) { c.overlap_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.step_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.approach_mm = 1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.travel_mm_s = -5.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.preflow_s = -0.1; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_wrist_turn_rad = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.passes[0].speed_mm_s = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.passes[0].across_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) {
    c.passes[0].weave = {dseam::torch::WeaveShape::kSine, 1.0, 0.0};
  }));
  EXPECT_TRUE(refused([](auto& c) { c.resume.run_up_mm = -1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.num_sectors = 17; }));
  EXPECT_TRUE(refused([](auto& c) {
    c.num_sectors = 1;
    c.sectors[0].to_mm = kNan;
  }));
}

}  // namespace
