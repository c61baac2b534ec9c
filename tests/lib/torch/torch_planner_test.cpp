// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "dseam/base/random.hpp"
#include "lib/torch/planned_torch.hpp"

namespace {

using dseam::seam::SeamPoint;
using dseam::test::kMaxSeamPoints;
using dseam::test::plan_torch;
using dseam::test::PlannedTorch;
using dseam::test::Saddle;
using dseam::torch::TorchPlanner;
using dseam::torch::TorchPoint;
using dseam::torch::Weldable;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
/// Angle of the torch's body over the shell in the plane across the true tangent.
double work_angle(const SeamPoint& truth, const TorchPoint& torch) {
  Vector3d body = -(torch.pose.q_base_torch * Vector3d::UnitZ());
  body -= truth.tangent * truth.tangent.dot(body);
  const Vector3d along_shell =
      (truth.n_nozzle - truth.n_shell * truth.n_shell.dot(truth.n_nozzle)).normalized();
  return std::atan2(body.dot(truth.n_shell), body.dot(along_shell));
}

const Saddle kSaddles[] = {{100.0, 40.0, 90 * kDegree, 0.0},  {100.0, 40.0, 60 * kDegree, 0.0},
                           {100.0, 40.0, 65 * kDegree, 15.0}, {108.0, 59.2, 62.9 * kDegree, 1.4},
                           {60.0, 20.0, 75 * kDegree, 20.0},  {300.0, 25.0, 90 * kDegree, 0.0}};
/// Where smoothing over a fixed length would bend the angles.
const Saddle kSmallSaddles[] = {{60.0, 12.0, 90 * kDegree, 0.0}, {30.0, 8.0, 70 * kDegree, 4.0}};

TEST(TorchPlanner, work_and_travel_angle_are_within_half_a_degree_of_the_closed_form) {
  for (const Saddle& saddle : kSaddles) {
    for (const std::size_t count : {120U, 360U, 1500U}) {
      for (const bool reversed : {false, true}) {
        TorchPlanner::Config config;
        config.travel_angle_rad = 10 * kDegree;
        config.work_offset_rad = 4 * kDegree;
        config.reversed = reversed;
        const auto points = saddle.points(count);

        const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

        ASSERT_EQ(planned.report.state, TorchPlanner::State::kPlanned);
        for (const TorchPoint& point : planned.points) {
          SeamPoint truth = saddle.at(saddle.angle_of(point.pose.p_base));
          const Vector3d travel = reversed ? Vector3d(-truth.tangent) : truth.tangent;
          const Vector3d wire = point.pose.q_base_torch * Vector3d::UnitZ();
          EXPECT_NEAR(work_angle(truth, point), 0.5 * truth.dihedral_rad + 4 * kDegree,
                      0.5 * kDegree);
          EXPECT_NEAR(std::asin(wire.dot(travel)), 10 * kDegree, 0.5 * kDegree);
          EXPECT_LT((point.pose.p_base - truth.p_base).norm(), 0.01);
          EXPECT_GT((point.pose.q_base_torch * Vector3d::UnitX()).dot(travel), 0.9);
        }
      }
    }
  }
}

/// The seam with white noise of a hundredth on each coordinate: mm of the points, and of the
/// normals, which makes them 0.6 degree wrong each.
std::vector<SeamPoint> noisy(std::vector<SeamPoint> points, std::uint64_t seed) {
  dseam::Pcg32 random(seed);
  const auto noise = [&] {
    const auto one = [&] { return 0.024 * (random.uniform() + random.uniform() - 1.0); };
    return Vector3d(one(), one(), one());
  };
  for (SeamPoint& point : points) {
    point.p_base += noise();
    point.n_shell = (point.n_shell + noise()).normalized();
    point.n_nozzle = (point.n_nozzle + noise()).normalized();
  }
  return points;
}

TEST(TorchPlanner, half_a_degree_also_holds_with_noise_on_normals_and_points) {
  TorchPlanner::Config config;
  config.travel_angle_rad = 10 * kDegree;
  for (const Saddle& saddle : kSaddles) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto points = noisy(saddle.points(720), seed);

      const PlannedTorch planned = plan_torch(config, dseam::test::view_of(points));

      for (const TorchPoint& point : planned.points) {
        const SeamPoint truth = saddle.at(saddle.angle_of(point.pose.p_base));
        const Vector3d wire = point.pose.q_base_torch * Vector3d::UnitZ();
        EXPECT_NEAR(work_angle(truth, point), 0.5 * truth.dihedral_rad, 0.5 * kDegree);
        EXPECT_NEAR(std::asin(wire.dot(truth.tangent)), 10 * kDegree, 0.5 * kDegree);
      }
    }
  }
}

TEST(TorchPlanner, smoothing_leaves_a_small_nozzle_its_angles) {
  for (const Saddle& saddle : kSmallSaddles) {
    const auto points = saddle.points(360);

    const PlannedTorch planned = plan_torch({}, dseam::test::view_of(points));

    for (const TorchPoint& point : planned.points) {
      const SeamPoint truth = saddle.at(saddle.angle_of(point.pose.p_base));
      const Vector3d wire = point.pose.q_base_torch * Vector3d::UnitZ();
      EXPECT_NEAR(work_angle(truth, point), 0.5 * truth.dihedral_rad, 0.5 * kDegree);
      EXPECT_NEAR(std::asin(wire.dot(truth.tangent)), 0.0, 0.5 * kDegree);
    }
  }
}

TEST(TorchPlanner, arc_length_is_that_of_the_curve_and_not_of_its_chords) {
  for (const Saddle& saddle : kSaddles) {
    const auto points = saddle.points(120);

    const PlannedTorch planned = plan_torch({}, dseam::test::view_of(points));

    const double truth_mm = saddle.length_mm();
    EXPECT_NEAR(planned.report.length_mm, truth_mm, 1e-4 * truth_mm);
  }
}

TEST(TorchPlanner, a_joint_without_two_normals_is_degenerate_and_keeps_the_last_orientation) {
  auto points = Saddle{}.points(360);
  for (std::size_t i = 100; i < 150; ++i) {
    points[i].n_nozzle = points[i].n_shell;
  }
  for (std::size_t i = 200; i < 250; ++i) {
    points[i].n_nozzle.setConstant(std::numeric_limits<double>::quiet_NaN());
  }

  const PlannedTorch planned = plan_torch({}, dseam::test::view_of(points));

  EXPECT_GT(planned.count(Weldable::kDegenerate), 60U);
  for (const TorchPoint& point : planned.points) {
    EXPECT_NEAR(point.pose.q_base_torch.norm(), 1.0, 1e-9);
  }
}

TEST(TorchPlanner, bad_seams_are_named) {
  const auto good = Saddle{}.points(100);
  auto nan = good;
  nan[3].p_base.x() = std::numeric_limits<double>::quiet_NaN();
  auto twice = good;
  twice[4].p_base = twice[3].p_base;
  const auto too_long = Saddle{}.points(kMaxSeamPoints + 1);

  EXPECT_EQ(plan_torch({}, {}).report.state, TorchPlanner::State::kNoSeam);
  EXPECT_EQ(plan_torch({}, {.points = std::span(good).first(3)}).report.state,
            TorchPlanner::State::kNoSeam);
  EXPECT_EQ(plan_torch({}, {.points = nan}).report.state, TorchPlanner::State::kBadPoint);
  EXPECT_EQ(plan_torch({}, {.points = twice}).report.state, TorchPlanner::State::kBadPoint);
  EXPECT_EQ(plan_torch({}, {.points = too_long}).report.state, TorchPlanner::State::kTooLong);
  EXPECT_EQ(plan_torch({}, {.points = good}, 20).report.state, TorchPlanner::State::kFull);
}

TEST(TorchPlanner, an_open_seam_keeps_both_its_ends) {
  auto points = Saddle{}.points(360);
  points.resize(180);
  dseam::seam::SeamView view = dseam::test::view_of(points);
  view.closed = false;

  const PlannedTorch planned = plan_torch({}, view);

  EXPECT_LT((planned.points.front().pose.p_base - points.front().p_base).norm(), 1e-9);
  EXPECT_LT((planned.points.back().pose.p_base - points.back().p_base).norm(), 1e-6);
}

TEST(TorchPlanner, values_out_of_range_are_refused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  dseam::test::ArenaOwner owner(TorchPlanner::bytes(10));
  const auto refused = [&](auto set) {
    TorchPlanner::Config config;
    set(config);
    return TorchPlanner::make(config, 10, owner.arena()).error() == dseam::Errc::kInvalidArgument;
  };

  EXPECT_TRUE(refused([](auto& c) { c.step_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.step_mm = -1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.smoothing_mm = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.work_fraction = 1.1; }));
  EXPECT_TRUE(refused([](auto& c) { c.travel_angle_rad = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_dihedral_rad = 0.1; }));
  EXPECT_TRUE(refused([](auto& c) { c.up_base.setZero(); }));
  EXPECT_TRUE(refused([](auto& c) { c.max_turn_rad_per_mm = 0.0; }));
}

}  // namespace
