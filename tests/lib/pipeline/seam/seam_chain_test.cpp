// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/seam_chain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "support/accuracy/seam_finder.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::pipeline {
namespace {

using seam::SeamReport;
using test::JointCloud;
using test::JointCloudConfig;
using test::paper_joint;
using test::SeamFinder;

constexpr double kDegree = std::numbers::pi / 180.0;

struct Joint {
  const char* name;
  JointCloudConfig config;
  double max_error_mm;
};

class SeamOfJoint : public testing::TestWithParam<Joint> {};

TEST_P(SeamOfJoint, lies_on_the_true_curve_all_round) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    JointCloudConfig config = GetParam().config;
    config.seed = seed;
    const JointCloud cloud(config);
    SeamFinder finder;

    const SeamReport report = finder.find(cloud);

    EXPECT_TRUE(report.weld()) << name(report.refusal);
    EXPECT_GE(report.quality.coverage, 0.99);
    EXPECT_LT(finder.worst_error(cloud.curve(3600, config.gap_mm)), GetParam().max_error_mm);
  }
}

std::vector<Joint> joints() {
  std::vector<Joint> joints;
  joints.push_back({"the_paper", paper_joint(), 0.01});
  JointCloudConfig upright;
  joints.push_back({"upright", upright, 0.01});
  JointCloudConfig eccentric = paper_joint();
  eccentric.eccentricity_mm = 20.0;
  joints.push_back({"eccentric", eccentric, 0.01});
  JointCloudConfig oval = paper_joint();
  oval.nozzle_ovality_mm = 0.3;
  joints.push_back({"oval", oval, 0.03});
  oval.nozzle_radius_mm = 84.0;
  oval.nozzle_ovality_mm = 0.8;
  joints.push_back({"as_oval_as_a_pipe_may_be", oval, 0.05});
  JointCloudConfig dead_band = paper_joint();
  dead_band.dead_band_mm = 2.0;
  joints.push_back({"dead_band", dead_band, 0.02});
  JointCloudConfig noisy = paper_joint();
  noisy.noise_mm = 0.3;
  joints.push_back({"noise_0_3", noisy, 0.1});
  JointCloudConfig plane = paper_joint();
  plane.shell = JointCloudConfig::Shell::kPlane;
  joints.push_back({"plane", plane, 0.01});
  JointCloudConfig sphere = paper_joint();
  sphere.shell = JointCloudConfig::Shell::kSphere;
  sphere.shell_radius_mm = 220.0;
  sphere.nozzle_radius_mm = 35.0;
  joints.push_back({"sphere", sphere, 0.01});
  JointCloudConfig cone = paper_joint();
  cone.nozzle_slope = -0.1;
  joints.push_back({"cone", cone, 0.01});
  JointCloudConfig large = paper_joint();
  large.shell_radius_mm = 300.0;
  large.nozzle_radius_mm = 150.0;
  large.nozzle_height_mm = 160.0;
  large.spacing_mm = 2.0;
  joints.push_back({"large", large, 0.01});
  JointCloudConfig small = paper_joint();
  small.shell_radius_mm = 60.0;
  small.nozzle_radius_mm = 20.0;
  small.shell_reach_mm = 40.0;
  joints.push_back({"small", small, 0.02});
  JointCloudConfig wide = paper_joint();
  wide.axis_angle_rad = std::numbers::pi / 2.0;
  wide.eccentricity_mm = 0.0;
  wide.nozzle_radius_mm = 100.0;
  joints.push_back({"nearly_as_wide_as_the_shell", wide, 0.02});
  return joints;
}

INSTANTIATE_TEST_SUITE_P(Joints, SeamOfJoint, testing::ValuesIn(joints()),
                         [](const auto& given) { return std::string(given.param.name); });

// A ring higher up a cone is narrower, as one in a bore is.
TEST(SeamChain, keeps_the_wall_of_a_cone_that_carries_a_collar) {
  JointCloudConfig config;
  config.shell = JointCloudConfig::Shell::kPlane;
  config.nozzle_slope = -0.1;
  JointCloud cloud(config);
  const double height_mm = 40.0;
  const double radius_mm = config.nozzle_radius_mm + config.nozzle_slope * height_mm;
  for (double phi = 0.0; phi < 0.4 * 2.0 * std::numbers::pi; phi += 1.0 / radius_mm) {
    for (double away_mm = 0.5; away_mm < 25.0; away_mm += 1.0) {
      const double r = radius_mm + away_mm;
      cloud.add({r * std::cos(phi), r * std::sin(phi), height_mm});
    }
  }
  SeamFinder finder;
  const SeamReport without = finder.find(JointCloud(config));

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  EXPECT_GT(report.joint.num_nozzle_points, 0.95 * without.joint.num_nozzle_points);
}

TEST(SeamChain, gives_an_ordered_closed_curve_with_even_steps_and_the_normals_of_both_surfaces) {
  const JointCloud cloud(paper_joint());
  SeamFinder finder;

  const SeamReport report = finder.find(cloud);

  const auto points = finder.points();
  ASSERT_GT(points.size(), 100U);
  const double step = report.length_mm / static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const seam::SeamPoint& next = points[(i + 1) % points.size()];
    EXPECT_NEAR((next.p_base - points[i].p_base).norm(), step, 1e-3);
    EXPECT_NEAR(points[i].s_mm, step * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(points[i].tangent.dot((next.p_base - points[i].p_base).normalized()), 1.0, 1e-3);
    EXPECT_NEAR(points[i].n_shell.dot(points[i].tangent), 0.0, 1e-9);
    EXPECT_GT(points[i].n_shell.z(), 0.0);
  }
  EXPECT_LT(report.quality.closure_mm, 1e-6);
}

TEST(SeamChain, finds_the_papers_dihedral_angles) {
  const JointCloud cloud(paper_joint());
  SeamFinder finder;

  (void)finder.find(cloud);

  double least = 10.0;
  double most = 0.0;
  for (const seam::SeamPoint& point : finder.points()) {
    least = std::min(least, point.dihedral_rad);
    most = std::max(most, point.dihedral_rad);
  }
  EXPECT_NEAR(least, 62.9 * kDegree, 1.0 * kDegree);
  EXPECT_GT(most, 117.0 * kDegree);
}

TEST(SeamChain, starts_at_the_angle_and_runs_in_the_direction_asked_for) {
  const JointCloud cloud(JointCloudConfig{});
  SeamFinder clockwise({.start_angle_rad = 0.5 * std::numbers::pi, .counter_clockwise = false});

  (void)clockwise.find(cloud);

  ASSERT_FALSE(clockwise.points().empty());
  const seam::SeamPoint& first = clockwise.points().front();
  EXPECT_NEAR(first.p_base.x(), 0.0, 0.05);
  EXPECT_NEAR(first.p_base.y(), 59.2, 0.05);
  EXPECT_NEAR(first.tangent.x(), 1.0, 1e-3);
}

TEST(SeamChain, the_same_cloud_gives_the_same_bits) {
  const JointCloud cloud(paper_joint());
  SeamFinder first;
  SeamFinder second;

  (void)first.find(cloud);
  (void)second.find(cloud);
  (void)second.find(cloud);

  ASSERT_EQ(first.points().size(), second.points().size());
  for (std::size_t i = 0; i < first.points().size(); ++i) {
    EXPECT_EQ(first.points()[i].p_base, second.points()[i].p_base);
  }
}

TEST(SeamChain, follows_the_part_into_any_frame) {
  JointCloud cloud(paper_joint());
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, -2.0, 0.5).normalized())).toRotationMatrix();
  const Eigen::Vector3d shift(700.0, 80.0, 260.0);
  std::vector<Eigen::Vector3d> truth = cloud.curve(3600, 0.0);
  for (Eigen::Vector3d& p : truth) {
    p = turn * p + shift;
  }
  cloud.transform(turn, shift, 1.0);
  SeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  EXPECT_LT(finder.worst_error(truth), 0.02);
}

TEST(SeamChain, a_hole_is_reported_where_it_is_and_bridged_as_interpolated) {
  JointCloudConfig config;
  config.unseen_start_rad = 1.0;
  config.unseen_width_rad = 0.15 * 2.0 * std::numbers::pi;
  const JointCloud cloud(config);
  SeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  EXPECT_NEAR(report.quality.coverage, 0.85, 0.02);
  ASSERT_EQ(report.num_holes, 1U);
  EXPECT_NEAR(report.holes[0].width_rad, config.unseen_width_rad, 3.0 * kDegree);
  EXPECT_LT(finder.worst_error(cloud.curve(3600, 0.0)), 0.02);
}

TEST(SeamChain, duplicate_and_wild_points_change_nothing_that_matters) {
  JointCloud cloud(paper_joint());
  for (int i = 0; i < 20000; ++i) {
    cloud.add({10.0, 10.0, -300.0});
  }
  cloud.add({1e30, 0.0, 0.0});
  cloud.add({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  SeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  EXPECT_EQ(report.num_not_finite, 2U);
  EXPECT_LT(finder.worst_error(cloud.curve(3600, 0.0)), 0.02);
}

TEST(SeamChain, run_does_not_allocate) {
  const JointCloud cloud(paper_joint());
  SeamFinder finder;
  const test::AllocationCounter allocations;

  (void)finder.find(cloud);

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::pipeline
