// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/motion_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::pipeline {
namespace {

constexpr double kRadius = 50.0;
constexpr double kLength = 2.0 * std::numbers::pi * kRadius;

/// A nozzle standing upright on a plate.
std::vector<seam::SeamPoint> round_seam(std::size_t count) {
  std::vector<seam::SeamPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(count);
    const double angle = 2.0 * std::numbers::pi * turn;
    const Eigen::Vector3d outward(std::cos(angle), std::sin(angle), 0.0);
    points[i].s_mm = turn * kLength;
    points[i].p_base = kRadius * outward;
    points[i].tangent = Eigen::Vector3d::UnitZ().cross(outward);
    points[i].n_shell = Eigen::Vector3d::UnitZ();
    points[i].n_nozzle = outward;
    points[i].dihedral_rad = std::numbers::pi / 2.0;
    points[i].confidence = seam::Confidence::kHigh;
    points[i].source = seam::Source::kMeasured;
  }
  return points;
}

class MotionChainTest : public ::testing::Test {
 protected:
  dseam::test::ArenaOwner memory_{MotionChain::bytes({})};
  MotionChain chain_ = MotionChain::make({}, {}, memory_.arena()).value();
};

TEST_F(MotionChainTest, a_round_seam_is_welded_once_around_and_past_its_start) {
  const auto points = round_seam(600);

  const dseam::test::AllocationCounter allocations;
  const auto report = chain_.run({points, kLength, true, seam::ReferenceCurve::kShellEdge});

  EXPECT_EQ(allocations.count(), 0U);
  ASSERT_TRUE(report.planned());
  EXPECT_NEAR(report.path.weld_mm, kLength + MotionChain::Config{}.path.overlap_mm, 1.0);
}

TEST_F(MotionChainTest, set_points_begin_and_end_at_rest_and_the_arc_burns_on_the_seam_alone) {
  const auto points = round_seam(600);
  ASSERT_TRUE(chain_.run({points, kLength, true, seam::ReferenceCurve::kShellEdge}).planned());
  auto sampler = chain_.sampler().value();

  trajectory::SetPoint point;
  trajectory::SetPoint last;
  std::uint32_t count = 0;
  while (sampler.next(point)) {
    EXPECT_TRUE(count > 0 || point.speed_mm_s == 0.0);
    if (point.arc) {
      EXPECT_NEAR(point.pose.p_base.head<2>().norm(), kRadius, 0.01);
      EXPECT_NEAR(point.pose.p_base.z(), 0.0, 0.01);
    }
    last = point;
    ++count;
  }

  EXPECT_EQ(count, sampler.size());
  EXPECT_EQ(last.speed_mm_s, 0.0);
  EXPECT_FALSE(last.arc);
}

TEST_F(MotionChainTest, a_seam_without_points_plans_nothing) {
  EXPECT_FALSE(chain_.run({}).planned());

  EXPECT_TRUE(chain_.path().empty());
  EXPECT_FALSE(chain_.sampler().ok());
}

TEST(MotionChain, too_little_memory_is_said_at_make) {
  dseam::test::ArenaOwner memory(MotionChain::bytes({}) / 2);

  EXPECT_EQ(MotionChain::make({}, {}, memory.arena()).error(), Errc::kOutOfMemory);
}

}  // namespace
}  // namespace dseam::pipeline
