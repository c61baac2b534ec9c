// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "dseam/pipeline/open_seam_chain.hpp"
#include "open_seam_finder.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::pipeline {
namespace {

using seam::ReferenceCurve;
using seam::Refusal;
using seam::SeamReport;
using test::OpenSeamFinder;
using test::PlateCloud;
using test::PlateCloudConfig;

struct Plates {
  const char* name;
  PlateCloudConfig config;
  double max_error_mm;
};

class OpenSeamOfPlates : public testing::TestWithParam<Plates> {};

TEST_P(OpenSeamOfPlates, lies_on_the_true_line_and_ends_where_the_plates_end) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    PlateCloudConfig config = GetParam().config;
    config.seed = seed;
    const PlateCloud cloud(config);
    OpenSeamFinder finder({.reference = ReferenceCurve::kRoot});

    const SeamReport report = finder.find(cloud);

    ASSERT_TRUE(report.weld()) << name(report.refusal);
    EXPECT_FALSE(report.closed);
    EXPECT_GE(report.quality.coverage, 0.99);
    EXPECT_LT(finder.worst_error(cloud), GetParam().max_error_mm);
    EXPECT_LT(finder.worst_end_error(cloud, config), config.spacing_mm);
    EXPECT_NEAR(report.length_mm, config.length_mm, 2.0 * config.spacing_mm);
    EXPECT_LT(report.end_sigma_mm, config.spacing_mm);
  }
}

std::vector<Plates> plates() {
  std::vector<Plates> plates;
  const PlateCloudConfig fillet;
  plates.push_back({"fillet", fillet, 0.02});
  PlateCloudConfig leaning = fillet;
  leaning.lean_rad = 0.4;
  plates.push_back({"leaning_fillet", leaning, 0.02});
  PlateCloudConfig bulging = fillet;
  bulging.curve_radius_mm = 150.0;
  plates.push_back({"fillet_of_a_bulging_plate", bulging, 0.03});
  PlateCloudConfig hollow = fillet;
  hollow.curve_radius_mm = -200.0;
  plates.push_back({"fillet_of_a_hollow_plate", hollow, 0.03});
  PlateCloudConfig bowed = fillet;
  bowed.bow_mm = 0.5;
  plates.push_back({"fillet_on_a_bowed_plate", bowed, 0.08});
  PlateCloudConfig noisy = fillet;
  noisy.noise_mm = 0.1;
  plates.push_back({"noise_0_1", noisy, 0.05});
  PlateCloudConfig dead_band = fillet;
  dead_band.dead_band_mm = 2.0;
  plates.push_back({"dead_band", dead_band, 0.03});
  PlateCloudConfig short_and_coarse = fillet;
  short_and_coarse.length_mm = 80.0;
  short_and_coarse.spacing_mm = 1.5;
  plates.push_back({"short_and_coarse", short_and_coarse, 0.03});
  PlateCloudConfig butt;
  butt.kind = PlateCloudConfig::Kind::kButt;
  butt.gap_mm = 2.0;
  plates.push_back({"butt", butt, 0.15});
  PlateCloudConfig narrow = butt;
  narrow.gap_mm = 1.0;
  narrow.spacing_mm = 0.5;
  narrow.width_mm = 40.0;
  narrow.length_mm = 120.0;
  plates.push_back({"narrow_butt", narrow, 0.1});
  PlateCloudConfig wide = butt;
  wide.gap_mm = 5.0;
  plates.push_back({"wide_butt", wide, 0.15});
  PlateCloudConfig stepped = butt;
  stepped.step_mm = 1.2;
  plates.push_back({"stepped_butt", stepped, 0.15});
  return plates;
}

INSTANTIATE_TEST_SUITE_P(Plates, OpenSeamOfPlates, testing::ValuesIn(plates()),
                         [](const auto& given) { return std::string(given.param.name); });

TEST(OpenSeamChain, follows_the_plates_into_any_frame) {
  PlateCloudConfig config;
  PlateCloud cloud(config);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  const Eigen::Vector3d shift(700.0, 80.0, 260.0);
  cloud.transform(turn, shift, 1.0);
  OpenSeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  const PlateCloud original(config);
  for (const seam::SeamPoint& point : finder.points()) {
    EXPECT_LT(original.distance(turn.transpose() * (point.p_base - shift)), 0.03);
  }
}

TEST(OpenSeamChain, gives_an_ordered_open_curve_with_the_normals_of_both_sides) {
  const PlateCloud cloud(PlateCloudConfig{});
  OpenSeamFinder finder;

  const SeamReport report = finder.find(cloud);

  const auto points = finder.points();
  ASSERT_GT(points.size(), 100U);
  const double step = report.length_mm / static_cast<double>(points.size() - 1);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d way = points[i + 1].p_base - points[i].p_base;
    EXPECT_NEAR(way.norm(), step, 1e-3);
    EXPECT_NEAR(points[i].tangent.dot(way.normalized()), 1.0, 1e-4);
    EXPECT_GT(points[i].n_shell.z(), 0.999);
    EXPECT_GT(points[i].n_nozzle.y(), 0.999);
    EXPECT_NEAR(points[i].dihedral_rad, 0.5 * std::numbers::pi, 1e-3);
  }
  EXPECT_LT(points.front().tangent.x(), -0.999);  // The standing plate lies to the left.
}

TEST(OpenSeamChain, runs_the_other_way_where_that_is_asked_for) {
  const PlateCloud cloud(PlateCloudConfig{});
  OpenSeamFinder finder({.counter_clockwise = false});

  (void)finder.find(cloud);

  ASSERT_FALSE(finder.points().empty());
  EXPECT_GT(finder.points().front().tangent.x(), 0.999);
  EXPECT_LT(finder.points().front().p_base.x(), 0.0);
}

TEST(OpenSeamChain, tells_gap_and_mismatch_of_a_butt) {
  for (const double step_mm : {0.0, 1.2}) {
    PlateCloudConfig config;
    config.kind = PlateCloudConfig::Kind::kButt;
    config.gap_mm = 3.0;
    config.step_mm = step_mm;
    const PlateCloud cloud(config);
    OpenSeamFinder finder({.reference = ReferenceCurve::kGapMiddle});

    const SeamReport report = finder.find(cloud);

    EXPECT_NEAR(report.joint.mean_gap_mm, config.gap_mm, 0.8 * config.spacing_mm);
    EXPECT_NEAR(report.joint.mean_mismatch_mm, step_mm, 0.03);
  }
}

TEST(OpenSeamChain, the_curves_of_a_plate_that_stands_off_lie_one_above_the_other) {
  PlateCloudConfig config;
  config.gap_mm = 2.0;
  const PlateCloud cloud(config);
  for (const auto& [reference, height] : {std::pair{ReferenceCurve::kRoot, 0.0},
                                          {ReferenceCurve::kShellEdge, 0.0},
                                          {ReferenceCurve::kGapMiddle, 1.0},
                                          {ReferenceCurve::kNozzleEdge, 2.0}}) {
    OpenSeamFinder finder({.reference = reference});

    const SeamReport report = finder.find(cloud);

    EXPECT_TRUE(report.weld()) << name(report.refusal);
    EXPECT_NEAR(report.joint.mean_mismatch_mm, 2.0, 0.4 * config.spacing_mm);
    for (const seam::SeamPoint& point : finder.points()) {
      EXPECT_NEAR(point.p_base.z(), height, 0.4 * config.spacing_mm);
      EXPECT_NEAR(point.p_base.y(), 0.0, 0.02);
    }
  }
}

TEST(OpenSeamChain, a_hole_is_reported_where_it_is_and_bridged_as_interpolated) {
  PlateCloudConfig config;
  config.unseen_from_mm = -40.0;
  config.unseen_to_mm = -15.0;
  const PlateCloud cloud(config);
  OpenSeamFinder finder({.counter_clockwise = false});

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  ASSERT_EQ(report.num_holes, 1U);
  const double turn = 2.0 * std::numbers::pi;
  EXPECT_NEAR(report.holes[0].start_rad / turn * config.length_mm, 60.0, 4.0);
  EXPECT_NEAR(report.holes[0].width_rad / turn * config.length_mm, 25.0, 4.0);
  EXPECT_LT(finder.worst_error(cloud), 0.03);
}

TEST(OpenSeamChain, clutter_does_not_move_it) {
  PlateCloudConfig config;
  PlateCloud cloud(config);
  cloud.add_box({-60.0, 10.0, 0.0}, {-30.0, 40.0, 15.0});
  cloud.add_box({40.0, 15.0, 0.0}, {60.0, 35.0, 10.0});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-60.0, 60.0);
  for (int i = 0; i < 300; ++i) {
    cloud.add({anywhere(random), std::abs(anywhere(random)), std::abs(anywhere(random))});
  }
  OpenSeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
  EXPECT_LT(finder.worst_error(cloud), 0.03);
  EXPECT_LT(finder.worst_end_error(cloud, config), config.spacing_mm);
}

TEST(OpenSeamChain, run_does_not_allocate) {
  PlateCloudConfig butt;
  butt.kind = PlateCloudConfig::Kind::kButt;
  butt.gap_mm = 2.0;
  for (const PlateCloudConfig& config : {PlateCloudConfig{}, butt}) {
    const PlateCloud cloud(config);
    OpenSeamFinder finder;
    const test::AllocationCounter allocations;

    (void)finder.find(cloud);

    EXPECT_EQ(allocations.count(), 0U);
  }
}

}  // namespace
}  // namespace dseam::pipeline
