// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/icp.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::splice {
namespace {

struct Cloud {
  std::vector<float> x, y, z, nx, ny, nz, variation;

  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
    nx.push_back(static_cast<float>(n.x()));
    ny.push_back(static_cast<float>(n.y()));
    nz.push_back(static_cast<float>(n.z()));
    variation.push_back(0.0F);
  }
  cloud::CloudView view() const { return {x, y, z}; }
  cloud::NormalsView normals() const { return {nx, ny, nz, variation}; }
};

// The upper half of a pipe along x, at 2 mm.
void add_shell(Cloud& out) {
  for (double along = -100.0; along < 100.0; along += 2.0) {
    for (double angle = -1.2; angle < 1.2; angle += 0.02) {
      const Eigen::Vector3d n(0.0, std::sin(angle), std::cos(angle));
      out.add(Eigen::Vector3d(along, 0.0, 0.0) + 100.0 * n, n);
    }
  }
}

void add_nozzle(Cloud& out) {
  for (double up = 105.0; up < 180.0; up += 2.0) {
    for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += 0.05) {
      const Eigen::Vector3d n(std::cos(angle), std::sin(angle), 0.0);
      out.add(Eigen::Vector3d(0.0, 0.0, up) + 40.0 * n, n);
    }
  }
}

Cloud saddle() {
  Cloud out;
  add_shell(out);
  add_nozzle(out);
  return out;
}

Icp::Report run(const Cloud& source, const Cloud& target, const geometry::RigidTransform& start,
                const Icp::Config& config = {}) {
  test::ArenaOwner owner(search::GridIndex::bytes(target.x.size() + 1));
  auto index = search::GridIndex::make(target.x.size() + 1, owner.arena());
  (void)index.value().rebuild(target.view());
  const test::AllocationCounter allocations;
  const Icp::Report report =
      Icp(config).run(source.view(), target.view(), target.normals(), index.value(), start);
  EXPECT_EQ(allocations.count(), 0U);
  return report;
}

const geometry::RigidTransform kOff{geometry::rotation_exp(Eigen::Vector3d(0.006, -0.004, 0.005)),
                                    Eigen::Vector3d(1.5, -1.0, 0.8)};

TEST(Icp, point_to_plane_brings_a_nozzle_on_a_shell_home) {
  const Icp::Report report = run(saddle(), saddle(), kOff);

  EXPECT_EQ(report.stop, IcpStop::kNoLongerFalls);
  EXPECT_EQ(report.observability.num_frozen, 0U);
  EXPECT_LT(report.T_target_source.translation_mm.norm(), 0.02);
  EXPECT_LT(geometry::rotation_log(report.T_target_source.rotation).norm(), 2e-4);
}

TEST(Icp, sliding_along_a_pipe_and_spinning_about_it_are_named_and_held) {
  Cloud pipe;
  add_shell(pipe);

  const Icp::Report report = run(pipe, pipe, kOff);

  ASSERT_EQ(report.observability.num_frozen, 2U);
  // Both free motions leave the pipe on itself: a slide along x, a turn about x.
  for (Eigen::Index i = 0; i < 2; ++i) {
    const geometry::Vector6 d = report.observability.directions.col(i);
    EXPECT_LT(std::abs(d(4)) + std::abs(d(5)), 0.05);
  }
  // The slide that the start had is still there: nothing drifted.
  EXPECT_NEAR(report.T_target_source.translation_mm.x(), kOff.translation_mm.x(), 0.7);
  EXPECT_GT(report.covariance(0, 0), 1e3);
}

TEST(Icp, point_to_point_stops_by_the_papers_threshold_on_the_same_points) {
  Icp::Config config;
  config.metric = IcpMetric::kPointToPoint;
  config.max_iterations = 200;
  const geometry::RigidTransform near{Eigen::Matrix3d::Identity(), {0.3, 0.2, -0.1}};

  const Icp::Report report = run(saddle(), saddle(), near, config);

  EXPECT_EQ(report.stop, IcpStop::kBelowThreshold);
  EXPECT_LT(report.error_mm2, 1e-3);
}

TEST(Icp, clouds_apart_have_no_overlap_and_stay_where_they_are) {
  const geometry::RigidTransform far{Eigen::Matrix3d::Identity(), {900.0, 0.0, 0.0}};

  const Icp::Report report = run(saddle(), saddle(), far);

  EXPECT_EQ(report.stop, IcpStop::kNoOverlap);
  EXPECT_EQ(report.T_target_source.translation_mm, far.translation_mm);
}

TEST(Icp, points_that_are_not_finite_and_empty_clouds_do_no_harm) {
  Cloud source = saddle();
  source.x[7] = std::numeric_limits<float>::quiet_NaN();
  source.z[70] = std::numeric_limits<float>::infinity();

  EXPECT_EQ(run(source, saddle(), kOff).stop, IcpStop::kNoLongerFalls);
  EXPECT_EQ(run({}, saddle(), kOff).stop, IcpStop::kNoOverlap);
  EXPECT_EQ(run(saddle(), {}, kOff).stop, IcpStop::kNoOverlap);
}

}  // namespace
}  // namespace dseam::splice
