// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pipeline_run.hpp"
#include "support/shapes/bevelled_plate.hpp"

namespace dseam::pipeline {
namespace {

using test::BevelledPlate;

/// About the seam's own centre: how far the base slides is another matter.
double worst_error_mm(const BevelledPlate& plate, std::span<const seam::SeamPoint> points) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const seam::SeamPoint& point : points) {
    centre += point.p_base / static_cast<double>(points.size());
  }
  double worst = 0.0;
  for (const seam::SeamPoint& point : points) {
    const Eigen::Vector3d p = point.p_base - centre;
    worst = std::max(worst, std::hypot(p.head<2>().norm() - plate.edge_radius_mm(), p.z()));
  }
  return worst;
}

class BevelledHole : public ::testing::TestWithParam<BevelledPlate> {};

// The bevel's uppermost tenth of a millimetre cannot be told from the plate.
TEST_P(BevelledHole, is_followed_where_its_bevel_begins) {
  const test::BevelledPlateScan scan(GetParam());

  const test::PipelineRun run(scan.frames(), scan.poses());

  EXPECT_TRUE(run.report().weld()) << name(run.report().seam.refusal);
  EXPECT_TRUE(run.report().seam.joint.has_gap);
  EXPECT_LT(worst_error_mm(GetParam(), run.seam()), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Widths, BevelledHole,
                         ::testing::Values(BevelledPlate{.gap_mm = 0.0, .bevel_mm = 2.0},
                                           BevelledPlate{.gap_mm = 1.0, .bevel_mm = 3.0},
                                           BevelledPlate{.gap_mm = 2.0, .bevel_mm = 0.0}));

// From a smeared edge nobody knows on which side of it the depths were taken.
TEST(SmearedHole, is_not_known_better_than_the_scanner_smears_it) {
  const BevelledPlate plate{.gap_mm = 2.0, .bevel_mm = 0.0, .smear_px = 2};
  const test::BevelledPlateScan scan(plate);

  const test::PipelineRun run(scan.frames(), scan.poses());

  const double sigma_mm = run.report().seam.quality.max_sigma_lateral_mm;
  EXPECT_FALSE(run.seam().empty());
  EXPECT_LT(worst_error_mm(plate, run.seam()), 3.0 * sigma_mm);
}

}  // namespace
}  // namespace dseam::pipeline
