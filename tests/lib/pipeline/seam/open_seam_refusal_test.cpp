// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "open_seam_finder.hpp"
#include "support/shapes/joint_cloud.hpp"

namespace dseam::pipeline {
namespace {

using seam::Refusal;
using seam::SeamReport;
using test::OpenSeamFinder;
using test::PlateCloud;
using test::PlateCloudConfig;

TEST(OpenSeamRefusal, no_points_and_none_that_are_finite_are_named) {
  PlateCloudConfig config;
  config.length_mm = 0.0;
  const PlateCloud empty(config);
  PlateCloud all_nan(config);
  for (int i = 0; i < 100; ++i) {
    all_nan.add(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  }
  OpenSeamFinder finder;

  EXPECT_EQ(finder.find(empty).refusal, Refusal::kEmptyCloud);
  EXPECT_EQ(finder.find(all_nan).refusal, Refusal::kEmptyCloud);
}

TEST(OpenSeamRefusal, a_cloud_in_metres_is_named) {
  PlateCloud cloud(PlateCloudConfig{});
  cloud.transform(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), 1e-3);
  OpenSeamFinder finder;

  EXPECT_EQ(finder.find(cloud).refusal, Refusal::kNotMillimetres);
}

TEST(OpenSeamRefusal, a_plate_alone_has_no_seam) {
  for (const double spacing_mm : {0.7, 1.0, 2.0}) {
    PlateCloudConfig config;
    config.kind = PlateCloudConfig::Kind::kButt;
    config.gap_mm = 0.0;
    config.spacing_mm = spacing_mm;
    const PlateCloud cloud(config);
    OpenSeamFinder finder;

    const SeamReport report = finder.find(cloud);

    EXPECT_EQ(report.refusal, Refusal::kNoSeam) << name(report.refusal);
    EXPECT_TRUE(finder.points().empty());
  }
}

TEST(OpenSeamRefusal, a_nozzle_on_a_shell_is_a_ring_and_no_open_seam) {
  const test::JointCloud cloud{test::JointCloudConfig{}};
  OpenSeamFinder finder;

  const SeamReport report = finder.find(SeamInput{.cloud_base = cloud.view()});

  EXPECT_FALSE(report.weld()) << name(report.refusal);
  EXPECT_EQ(report.refusal, Refusal::kNoSeam) << name(report.refusal);
}

TEST(OpenSeamRefusal, two_equal_seams_are_named_and_both_shown) {
  PlateCloudConfig config;
  config.second_face_mm = 25.0;
  const PlateCloud cloud(config);
  OpenSeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_EQ(report.refusal, Refusal::kTwoSeams) << name(report.refusal);
  ASSERT_GE(report.num_candidates, 2U);
  EXPECT_TRUE(finder.points().empty());
}

TEST(OpenSeamRefusal, what_a_thin_standing_plate_hides_is_no_gap) {
  for (const double thickness_mm : {6.0, 8.0, 12.0}) {
    PlateCloudConfig config;
    config.second_face_mm = thickness_mm;
    const PlateCloud cloud(config);
    OpenSeamFinder finder;

    EXPECT_FALSE(finder.find(cloud).weld()) << thickness_mm;
  }
}

TEST(OpenSeamRefusal, a_region_chooses_between_two_and_one_without_a_seam_is_named) {
  PlateCloudConfig config;
  config.second_face_mm = 25.0;
  const PlateCloud cloud(config);
  SeamInput front{.cloud_base = cloud.view()};
  front.region = RegionOfInterest{{-200.0, -5.0, -50.0}, {200.0, 200.0, 200.0}};
  SeamInput nowhere = front;
  nowhere.region = RegionOfInterest{{500.0, 500.0, 500.0}, {600.0, 600.0, 600.0}};
  OpenSeamFinder finder;

  EXPECT_EQ(finder.find(nowhere).refusal, Refusal::kOutsideRegion);
  EXPECT_TRUE(finder.find(front).weld());
  EXPECT_LT(finder.worst_error(cloud), 0.03);
}

// The same two plates, seen from where the joint is an outer corner.
TEST(OpenSeamRefusal, an_edge_that_is_seen_from_outside_is_no_seam) {
  const PlateCloud cloud(PlateCloudConfig{});
  const std::vector<cloud::ViewMask> seen(cloud.view().points.size(), 1U);
  std::vector<splice::SplicedView> views(1);
  views[0].state = splice::ViewState::kUsed;
  SeamInput in{.cloud_base = cloud.view(), .views = views};
  in.cloud_base.seen_by = seen;
  OpenSeamFinder finder;

  views[0].T_base_camera.translation_mm = {0.0, -400.0, -400.0};
  const Refusal from_outside = finder.find(in).refusal;
  views[0].T_base_camera.translation_mm = {0.0, 400.0, 400.0};
  const Refusal from_inside = finder.find(in).refusal;

  EXPECT_EQ(from_outside, Refusal::kNoSeam) << name(from_outside);
  EXPECT_EQ(from_inside, Refusal::kNone) << name(from_inside);
}

TEST(OpenSeamRefusal, a_reference_curve_that_the_joint_does_not_have_is_named) {
  const PlateCloud cloud(PlateCloudConfig{});
  for (const auto reference :
       {seam::ReferenceCurve::kGapMiddle, seam::ReferenceCurve::kNozzleEdge}) {
    OpenSeamFinder finder({.reference = reference});

    EXPECT_EQ(finder.find(cloud).refusal, Refusal::kNoSuchReference);
  }
}

TEST(OpenSeamRefusal, a_seam_half_unseen_is_refused) {
  PlateCloudConfig config;
  config.unseen_from_mm = -55.0;
  config.unseen_to_mm = -5.0;
  const PlateCloud cloud(config);
  OpenSeamFinder finder;

  const SeamReport report = finder.find(cloud);

  EXPECT_EQ(report.refusal, Refusal::kLowCoverage) << name(report.refusal);
  EXPECT_NEAR(report.quality.coverage, 0.75, 0.03);
}

TEST(OpenSeamRefusal, a_full_output_is_named) {
  const PlateCloud cloud(PlateCloudConfig{});
  OpenSeamFinder finder({}, 100);

  EXPECT_EQ(finder.find(cloud).refusal, Refusal::kFull);
  EXPECT_TRUE(finder.points().empty());
}

TEST(OpenSeamRefusal, an_arena_too_small_and_a_wrong_value_are_named) {
  test::ArenaOwner owner(1000);
  test::ArenaOwner large(OpenSeamChain::bytes({}));

  EXPECT_EQ(OpenSeamChain::make({}, {}, owner.arena()).error(), Errc::kOutOfMemory);
  EXPECT_EQ(OpenSeamChain::make({.point_spacing_mm = -1.0}, {}, large.arena()).error(),
            Errc::kInvalidArgument);
}

}  // namespace
}  // namespace dseam::pipeline
