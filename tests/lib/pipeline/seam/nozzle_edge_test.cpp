// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "dseam/hal/sim/cell.hpp"
#include "support/accuracy/fused_scan.hpp"
#include "support/accuracy/seam_accuracy.hpp"
#include "support/accuracy/seam_finder.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::pipeline {
namespace {

using seam::ReferenceCurve;
using seam::Refusal;
using seam::SeamReport;
using test::JointCloud;
using test::JointCloudConfig;
using test::SeamFinder;

/// A nozzle set on the shell, its end `gap_mm` above it, seen by half-size frames.
hal::sim::CellConfig set_on(double gap_mm, std::uint64_t seed) {
  hal::sim::CellConfig config;
  config.seed = seed;
  config.joint.kind = hal::sim::JointKind::kSetOn;
  config.joint.gap_mm = gap_mm;
  config.joint.axis_angle_rad = 1.2;
  config.joint.eccentricity_mm = 8.0;
  config.views.tilt_rad = 1.0;
  config.scanner.width = 648;
  config.scanner.height = 483;
  return config;
}

double mean_mismatch_of(std::span<const seam::SeamPoint> points) {
  double sum = 0.0;
  for (const seam::SeamPoint& point : points) {
    sum += point.mismatch_mm / static_cast<double>(points.size());
  }
  return sum;
}

struct Asked {
  double gap_mm;
  ReferenceCurve reference;
};

class NozzleEdgeOfFrames : public testing::TestWithParam<Asked> {};

TEST_P(NozzleEdgeOfFrames, lies_on_the_true_curve_with_the_true_mismatch) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto cell = hal::sim::Cell::make(set_on(GetParam().gap_mm, seed)).value();
    const test::TrueScan scan(cell);
    test::FusedScan fused(cell, scan);
    SeamFinder finder({.reference = GetParam().reference});

    const SeamReport report = finder.find(fused.input());

    ASSERT_TRUE(report.weld()) << name(report.refusal);
    const auto truth = cell.seam(GetParam().reference).value();
    const test::SeamAccuracy accuracy = test::measure_measured(finder.points(), truth, {});
    EXPECT_GE(accuracy.coverage, 0.99);
    EXPECT_LT(accuracy.rmse_mm, 0.03) << "seed " << seed;
    EXPECT_LT(accuracy.max_mm, 0.08) << "seed " << seed;
    EXPECT_NEAR(mean_mismatch_of(finder.points()), GetParam().gap_mm, 0.03);
    EXPECT_NEAR(report.joint.mean_mismatch_mm, GetParam().gap_mm, 0.03);
    EXPECT_EQ(report.joint.mean_gap_mm, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Joints, NozzleEdgeOfFrames,
                         testing::Values(Asked{2.0, ReferenceCurve::kNozzleEdge},
                                         Asked{1.0, ReferenceCurve::kNozzleEdge},
                                         Asked{2.0, ReferenceCurve::kGapMiddle}));

TEST(NozzleEdge, of_a_nozzle_that_goes_through_or_touches_is_refused_by_name) {
  for (const bool set_in : {true, false}) {
    hal::sim::CellConfig config = set_on(set_in ? 2.0 : 0.0, 1);
    config.joint.kind = set_in ? hal::sim::JointKind::kSetIn : hal::sim::JointKind::kSetOn;
    const auto cell = hal::sim::Cell::make(config).value();
    const test::TrueScan scan(cell);
    test::FusedScan fused(cell, scan);
    SeamFinder finder({.reference = ReferenceCurve::kNozzleEdge});

    const SeamReport report = finder.find(fused.input());

    EXPECT_EQ(report.refusal, Refusal::kNoSuchReference) << name(report.refusal);
    EXPECT_TRUE(finder.points().empty());
    EXPECT_EQ(report.joint.mean_mismatch_mm, 0.0);
  }
}

class NozzleEdgeOfCloud : public testing::TestWithParam<double> {};

// A cloud's points end up to 0.4 of their spacing before an edge or past it, by how it was thinned.
TEST_P(NozzleEdgeOfCloud, is_found_within_four_tenths_of_the_points_spacing) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    JointCloudConfig config = test::paper_joint();
    config.seed = seed;
    config.raised_mm = GetParam();
    const JointCloud cloud(config);
    SeamFinder finder({.reference = ReferenceCurve::kNozzleEdge});

    const SeamReport report = finder.find(cloud);

    EXPECT_TRUE(report.weld()) << name(report.refusal);
    EXPECT_LT(finder.worst_error(cloud.curve(3600, 0.0, config.raised_mm)),
              0.4 * config.spacing_mm);
    EXPECT_NEAR(report.joint.mean_mismatch_mm, config.raised_mm, 0.4 * config.spacing_mm);
  }
}

INSTANTIATE_TEST_SUITE_P(Heights, NozzleEdgeOfCloud, testing::Values(1.5, 2.0, 4.0));

TEST(NozzleEdge, a_dead_band_that_takes_of_both_surfaces_alike_is_none) {
  JointCloudConfig config = test::paper_joint();
  config.dead_band_mm = 3.0;
  const JointCloud cloud(config);
  SeamFinder finder({.reference = ReferenceCurve::kNozzleEdge});

  EXPECT_EQ(finder.find(cloud).refusal, Refusal::kNoSuchReference);
}

TEST(NozzleEdge, run_does_not_allocate) {
  JointCloudConfig config = test::paper_joint();
  config.raised_mm = 2.0;
  const JointCloud cloud(config);
  SeamFinder finder({.reference = ReferenceCurve::kNozzleEdge});
  const test::AllocationCounter allocations;

  (void)finder.find(cloud);

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::pipeline
