// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "dseam/hal/sim/cell.hpp"
#include "open_seam_finder.hpp"
#include "support/accuracy/fused_scan.hpp"
#include "support/accuracy/seam_accuracy.hpp"

namespace dseam::pipeline {
namespace {

using hal::sim::JointKind;
using seam::ReferenceCurve;
using seam::SeamReport;
using test::OpenSeamFinder;

// As a scan is fused before its seam is sought.
constexpr float kCellMm = 1.0F;
constexpr float kReachMm = 130.0F;
constexpr float kMaxStepMm = 3.0F;

struct Asked {
  const char* name;
  JointKind kind;
  double gap_mm;
  double noise_mm;
  bool clutter;
  double max_rmse_mm;
  bool region = false;  ///< Drawn round the plates: clamps and rims over the table rival the seam.
};

/// Two plates under the simulated scanner, by half-size frames from their open side.
hal::sim::CellConfig plates(const Asked& asked, std::uint64_t seed) {
  hal::sim::CellConfig config;
  config.seed = seed;
  config.joint.kind = asked.kind;
  config.joint.shell = hal::sim::ShellKind::kPlane;
  config.joint.shell_length_mm = 180.0;
  config.joint.gap_mm = asked.gap_mm;
  config.scanner.noise_mm = asked.noise_mm;
  config.scanner.width = 648;
  config.scanner.height = 483;
  config.views.count = 4;
  config.views.first_azimuth_rad = 0.8;
  config.views.azimuth_span_rad = 1.5;
  config.markers.count = 6;
  if (asked.clutter) {
    config.clutter.num_clamps = 1;
    config.clutter.num_spatter = 20;
  }
  return config;
}

class OpenSeamOfScan : public testing::TestWithParam<Asked> {};

TEST_P(OpenSeamOfScan, lies_on_the_true_line) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto cell = hal::sim::Cell::make(plates(GetParam(), seed)).value();
    const test::TrueScan scan(cell);
    test::FusedScan fused(cell, scan, kCellMm, kReachMm, kMaxStepMm);
    OpenSeamFinder finder({.reference = ReferenceCurve::kRoot});

    SeamInput in = fused.input();
    if (GetParam().region) {
      const Eigen::Vector3d middle = cell.config().T_base_part.translation_mm;
      in.region = RegionOfInterest{middle - Eigen::Vector3d(60.0, 30.0, 8.0),
                                   middle + Eigen::Vector3d(60.0, 30.0, 60.0)};
    }
    const SeamReport report = finder.find(in);

    ASSERT_TRUE(report.weld()) << name(report.refusal) << ", seed " << seed;
    const auto truth = cell.seam(ReferenceCurve::kRoot).value();
    const test::SeamAccuracy accuracy = test::measure_measured(finder.points(), truth, {});
    EXPECT_GE(accuracy.coverage, 0.95) << "seed " << seed;
    EXPECT_LT(accuracy.rmse_mm, GetParam().max_rmse_mm) << "seed " << seed;
    EXPECT_NEAR(report.length_mm, truth.length_mm, 2.0) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Plates, OpenSeamOfScan,
    testing::Values(Asked{"fillet", JointKind::kTFillet, 0.0, 0.02, false, 0.03},
                    Asked{"fillet_noise_0_1", JointKind::kTFillet, 0.0, 0.1, false, 0.08},
                    Asked{"fillet_with_clutter", JointKind::kTFillet, 0.0, 0.02, true, 0.03, true},
                    Asked{"butt_3", JointKind::kButt, 3.0, 0.02, false, 0.15},
                    Asked{"butt_2", JointKind::kButt, 2.0, 0.02, false, 0.15, true}),
    [](const auto& given) { return std::string(given.param.name); });

}  // namespace
}  // namespace dseam::pipeline
