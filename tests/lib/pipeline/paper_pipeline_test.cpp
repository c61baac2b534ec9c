// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/paper_pipeline.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/joint_cloud.hpp"

namespace dseam::pipeline {
namespace {

using test::JointCloud;
using test::JointCloudConfig;

/// A shell seen alone: the hole that the nozzle left in it is its only inner rim.
JointCloudConfig shell_with_a_hole() {
  JointCloudConfig config;
  config.nozzle = false;
  return config;
}

/// The box that a person would draw round the joint: over the shell's sides, inside its outer rim.
PaperPipeline::Config around_joint() {
  PaperPipeline::Config config;
  config.constraints.low_mm = {-75.0F, -75.0F, -60.0F};
  config.constraints.high_mm = {75.0F, 75.0F, 20.0F};
  return config;
}

struct Found {
  PaperPipeline::Report report;
  std::vector<seam::SeamPoint> seam;
  std::uint64_t allocations = 0;
};

Found run_paper(const cloud::CloudView& cloud, const PaperPipeline::Config& config,
                std::size_t max_points = 60000) {
  test::ArenaOwner memory(PaperPipeline::bytes(max_points));
  auto chain = PaperPipeline::make(config, max_points, memory.arena());
  std::vector<seam::SeamPoint> points(8192);
  Buffer<seam::SeamPoint> out(points);
  const test::AllocationCounter allocations;
  Found done{chain.value().run(cloud, out), {}, 0};
  done.allocations = allocations.count();
  done.seam.assign(out.view().begin(), out.view().end());
  return done;
}

double rms_to(const std::vector<Eigen::Vector3d>& truth, const std::vector<seam::SeamPoint>& seam) {
  double squares = 0.0;
  for (const seam::SeamPoint& point : seam) {
    const double off = test::distance_to(truth, point.p_base);
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(seam.size()));
}

TEST(PaperPipeline, the_rim_of_a_hole_becomes_one_closed_curve_a_cell_off_the_edge) {
  const JointCloud cloud(shell_with_a_hole());

  const Found found = run_paper(cloud.view().points, around_joint());

  EXPECT_EQ(found.report.refusal, seam::Refusal::kNone) << name(found.report.refusal);
  ASSERT_FALSE(found.seam.empty());
  EXPECT_LT(rms_to(cloud.curve(4000, 0.0), found.seam), 3.0);
}

TEST(PaperPipeline, a_joint_that_was_seen_to_its_root_has_no_rim_and_is_refused) {
  const JointCloud cloud({});

  const Found found = run_paper(cloud.view().points, around_joint());

  EXPECT_NE(found.report.refusal, seam::Refusal::kNone)
      << found.report.constrained << " points, rms " << found.report.curve.orthogonal.rms_mm;
}

TEST(PaperPipeline, every_stage_counts_what_it_kept) {
  const JointCloud cloud(shell_with_a_hole());
  const cloud::CloudView points = cloud.view().points;

  const PaperPipeline::Report report = run_paper(points, around_joint()).report;

  EXPECT_EQ(report.passthrough.kept, points.size());
  EXPECT_EQ(report.outliers.kept + report.outliers.removed, report.passthrough.kept);
  EXPECT_LT(report.voxels.cells, report.outliers.kept);
  EXPECT_EQ(report.boundary.boundary + report.boundary.inner + report.boundary.too_few +
                report.boundary.without_normal,
            report.voxels.cells);
  EXPECT_LE(report.constrained, report.boundary.boundary);
  EXPECT_EQ(report.curve.num_points, report.constrained);
}

TEST(PaperPipeline, passthrough_drops_what_lies_beyond) {
  const JointCloud cloud(shell_with_a_hole());
  PaperPipeline::Config config = around_joint();
  config.passthrough.low_mm.x = 0.0F;

  const PaperPipeline::Report report = run_paper(cloud.view().points, config).report;

  EXPECT_GT(report.passthrough.dropped_outside, 0U);
  EXPECT_NE(report.refusal, seam::Refusal::kNone);
}

TEST(PaperPipeline, it_takes_no_memory_and_gives_the_same_bits_again) {
  const JointCloud cloud(shell_with_a_hole());
  const PaperPipeline::Config config = around_joint();

  const Found first = run_paper(cloud.view().points, config);
  const Found second = run_paper(cloud.view().points, config);

  EXPECT_EQ(first.allocations, 0U);
  ASSERT_EQ(first.seam.size(), second.seam.size());
  for (std::size_t i = 0; i < first.seam.size(); ++i) {
    EXPECT_EQ(first.seam[i].p_base, second.seam[i].p_base);
  }
}

TEST(PaperPipeline, nothing_one_point_and_too_many_are_refused) {
  const std::vector<float> nan(3, std::numeric_limits<float>::quiet_NaN());
  const std::vector<float> one{1.0F};
  const std::vector<float> many(2001, 1.0F);

  EXPECT_EQ(run_paper({}, {}).report.refusal, seam::Refusal::kEmptyCloud);
  EXPECT_EQ(run_paper({nan, nan, nan}, {}).report.refusal, seam::Refusal::kEmptyCloud);
  EXPECT_EQ(run_paper({one, one, one}, {}).report.refusal, seam::Refusal::kNoRing);
  EXPECT_EQ(run_paper({many, many, many}, {}, 2000).report.refusal, seam::Refusal::kFull);
}

TEST(PaperPipeline, a_value_out_of_range_and_a_small_arena_are_refused) {
  test::ArenaOwner memory(PaperPipeline::bytes(1000));
  test::ArenaOwner small(PaperPipeline::bytes(1000) / 2);
  PaperPipeline::Config impossible;
  impossible.cell_mm = -1.0F;

  EXPECT_EQ(PaperPipeline::make(impossible, 1000, memory.arena()).error(), Errc::kInvalidArgument);
  EXPECT_EQ(PaperPipeline::make({}, 1000, small.arena()).error(), Errc::kOutOfMemory);
}

}  // namespace
}  // namespace dseam::pipeline
