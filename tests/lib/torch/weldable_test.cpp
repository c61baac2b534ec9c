// SPDX-License-Identifier: Apache-2.0
// Where the torch may weld, and the reason at each point where it may not.
#include "lib/torch/planned_torch.hpp"

namespace {

using dseam::test::plan_torch;
using dseam::test::PlannedTorch;
using dseam::test::Saddle;
using dseam::torch::TorchPlanner;
using dseam::torch::TorchPoint;
using dseam::torch::Weldable;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

TEST(TorchPlanner, a_joint_too_open_or_too_closed_for_the_torch_says_so) {
  const Saddle saddle{100.0, 60.0, 60 * kDegree, 0.0};
  const auto points = saddle.points(720);
  TorchPlanner::Config config;
  config.min_dihedral_rad = 75 * kDegree;
  config.max_dihedral_rad = 110 * kDegree;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  for (const TorchPoint& point : planned.points) {
    const double truth_rad = saddle.at(saddle.angle_of(point.pose.p_base)).dihedral_rad;
    const bool outside = truth_rad < 74.9 * kDegree || truth_rad > 110.1 * kDegree;
    const bool inside = truth_rad > 75.1 * kDegree && truth_rad < 109.9 * kDegree;
    EXPECT_TRUE(!outside || point.weldable == Weldable::kDihedral) << truth_rad / kDegree;
    EXPECT_TRUE(!inside || point.weldable == Weldable::kYes) << truth_rad / kDegree;
  }
  EXPECT_GT(planned.count(Weldable::kDihedral), 100U);
  EXPECT_GT(planned.count(Weldable::kYes), 100U);
}

TEST(TorchPlanner, where_it_would_have_to_turn_faster_than_allowed_it_says_so) {
  const auto points = Saddle{100.0, 60.0, 60 * kDegree, 0.0}.points(720);
  const PlannedTorch unlimited = plan_torch({}, dseam::test::view_of(points));
  TorchPlanner::Config config;
  config.max_turn_rad_per_mm = 0.8 * unlimited.report.max_turn_rad_per_mm;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  for (std::size_t i = 1; i < planned.points.size(); ++i) {
    const TorchPoint& a = planned.points[i - 1];
    const TorchPoint& b = planned.points[i];
    const double rate =
        a.pose.q_base_torch.angularDistance(b.pose.q_base_torch) / (b.s_mm - a.s_mm);
    EXPECT_EQ(b.weldable == Weldable::kTurnsTooFast, rate > config.max_turn_rad_per_mm) << i;
  }
  EXPECT_GT(planned.count(Weldable::kTurnsTooFast), 0U);
}

TEST(TorchPlanner, the_contact_tip_keeps_its_clearance_or_the_point_says_so) {
  const auto points = Saddle{100.0, 40.0, 60 * kDegree, 0.0}.points(360);
  TorchPlanner::Config config;
  config.tip_radius_mm = 8.0;
  config.min_clearance_mm = 2.0;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  std::size_t touching = 0;
  for (const TorchPoint& point : planned.points) {
    const double half = 0.5 * point.dihedral_rad;
    EXPECT_NEAR(point.clearance_mm, 15.0 * std::sin(half) - 8.0 * std::cos(half), 1e-6);
    EXPECT_EQ(point.weldable == Weldable::kNoClearance, point.clearance_mm < 2.0);
    touching += point.clearance_mm < 2.0 ? 1 : 0;
  }
  EXPECT_GT(touching, 0U);
  EXPECT_LT(touching, planned.points.size());
}

TEST(TorchPlanner, the_tilt_limit_holds_and_costs_the_weld_where_it_takes_too_much) {
  const auto points = Saddle{100.0, 60.0, 60 * kDegree, 0.0}.points(360);
  TorchPlanner::Config config;
  config.max_tilt_rad = 45 * kDegree;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  for (const TorchPoint& point : planned.points) {
    const Vector3d body = -(point.pose.q_base_torch * Vector3d::UnitZ());
    EXPECT_LT(std::acos(std::min(1.0, body.z())), 45.0001 * kDegree);
  }
  EXPECT_GT(planned.count(Weldable::kTilt), 0U);
  EXPECT_GT(planned.count(Weldable::kYes), 0U);
}

TEST(TorchPlanner, interpolated_doubtful_and_gaping_points_are_not_weldable) {
  auto points = Saddle{}.points(360);
  for (std::size_t i = 0; i < 360; ++i) {
    points[i].source = i < 90 ? dseam::seam::Source::kInterpolated : points[i].source;
    points[i].confidence =
        i >= 90 && i < 180 ? dseam::seam::Confidence::kNone : points[i].confidence;
    points[i].gap_mm = i >= 180 && i < 270 ? 7.0 : 0.0;
  }

  const PlannedTorch planned = plan_torch({}, dseam::test::view_of(points));

  for (const Weldable reason :
       {Weldable::kInterpolated, Weldable::kLowConfidence, Weldable::kGap, Weldable::kYes}) {
    EXPECT_NEAR(planned.count(reason), static_cast<double>(planned.points.size()) / 4.0, 6.0);
  }
}

TEST(TorchPlanner, interpolated_points_are_weldable_when_the_configuration_allows_it) {
  auto points = Saddle{}.points(360);
  points[5].source = dseam::seam::Source::kInterpolated;
  points[5].confidence = dseam::seam::Confidence::kLow;
  TorchPlanner::Config config;
  config.weld_interpolated = true;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  EXPECT_EQ(planned.count(Weldable::kYes), planned.points.size());
}

TEST(TorchPlanner, interpolated_points_below_the_confidence_asked_for_are_not_weldable_either) {
  auto points = Saddle{}.points(360);
  for (std::size_t i = 0; i < 90; ++i) {
    points[i].source = dseam::seam::Source::kInterpolated;
    points[i].confidence = dseam::seam::Confidence::kNone;
  }
  TorchPlanner::Config config;
  config.weld_interpolated = true;

  const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

  EXPECT_NEAR(planned.count(Weldable::kLowConfidence),
              static_cast<double>(planned.points.size()) / 4.0, 6.0);
}

}  // namespace
