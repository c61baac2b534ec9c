// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

#include "dseam/pipeline/seam_chain.hpp"
#include "support/accuracy/seam_finder.hpp"

namespace dseam::pipeline {
namespace {

using seam::Refusal;
using seam::SeamReport;
using test::JointCloud;
using test::JointCloudConfig;
using test::paper_joint;
using test::SeamFinder;

struct Bad {
  const char* name;
  JointCloudConfig config;
  Refusal refusal;
};

TEST(SeamRefusal, what_cannot_be_welded_is_refused_by_name) {
  JointCloudConfig half;
  half.unseen_width_rad = std::numbers::pi;
  JointCloudConfig no_nozzle;
  no_nozzle.nozzle = false;
  JointCloudConfig plate = no_nozzle;
  plate.shell = JointCloudConfig::Shell::kPlane;
  JointCloudConfig no_shell;
  no_shell.shell_seen = false;
  JointCloudConfig wide_hole;
  wide_hole.unseen_width_rad = 0.19 * 2.0 * std::numbers::pi;
  const std::array<Bad, 5> bad = {{{"half seen", half, Refusal::kLowCoverage},
                                   {"no nozzle", no_nozzle, Refusal::kOneSurface},
                                   {"plate", plate, Refusal::kCoplanar},
                                   {"nozzle only", no_shell, Refusal::kOneSurface},
                                   {"wide hole", wide_hole, Refusal::kLargeHole}}};
  for (const Bad& one : bad) {
    SeamFinder finder;

    const SeamReport report = finder.find(JointCloud(one.config));

    EXPECT_EQ(report.refusal, one.refusal) << one.name << ": " << name(report.refusal);
  }
}

TEST(SeamRefusal, an_empty_cloud_and_one_of_nan_are_refused_as_empty) {
  SeamFinder finder;
  const std::vector<float> nan(100, std::numeric_limits<float>::quiet_NaN());

  const SeamReport empty = finder.find(SeamInput{});
  const SeamReport all_nan = finder.find(SeamInput{.cloud_base = {{nan, nan, nan}, {}, {}}});

  EXPECT_EQ(empty.refusal, Refusal::kEmptyCloud);
  EXPECT_EQ(all_nan.refusal, Refusal::kEmptyCloud);
  EXPECT_EQ(all_nan.num_not_finite, 100U);
}

TEST(SeamRefusal, a_cloud_in_metres_is_named) {
  JointCloud cloud{JointCloudConfig{}};
  cloud.transform(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), 1e-3);
  SeamFinder finder;

  EXPECT_EQ(finder.find(cloud).refusal, Refusal::kNotMillimetres);
}

TEST(SeamRefusal, a_region_without_the_seam_and_a_wrong_radius_are_named) {
  const JointCloud cloud(paper_joint());
  SeamInput elsewhere{.cloud_base = cloud.view()};
  elsewhere.region = RegionOfInterest{{500.0, 500.0, 500.0}, {600.0, 600.0, 600.0}};
  SeamInput other_radius{.cloud_base = cloud.view()};
  other_radius.expected_radius_mm = 30.0;
  SeamFinder finder;

  EXPECT_EQ(finder.find(elsewhere).refusal, Refusal::kOutsideRegion);
  EXPECT_EQ(finder.find(other_radius).refusal, Refusal::kOutsideRegion);
}

TEST(SeamRefusal, a_reference_curve_that_the_joint_does_not_have_is_named) {
  const JointCloud cloud(paper_joint());
  for (const auto reference :
       {seam::ReferenceCurve::kGapMiddle, seam::ReferenceCurve::kNozzleEdge}) {
    SeamFinder finder({.reference = reference});

    EXPECT_EQ(finder.find(cloud).refusal, Refusal::kNoSuchReference);
  }
}

TEST(SeamRefusal, two_equal_rings_are_named_and_both_shown) {
  JointCloud both(paper_joint());
  both.transform(Eigen::Matrix3d::Identity(), Eigen::Vector3d(400.0, 0.0, 0.0), 1.0);
  const JointCloud first(paper_joint());
  const auto& points = first.view().points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    both.add({double{points.x[i]}, double{points.y[i]}, double{points.z[i]} + 200.0});
  }
  SeamFinder finder;

  const SeamReport report = finder.find(both);

  EXPECT_EQ(report.refusal, Refusal::kTwoRings) << name(report.refusal);
  ASSERT_GE(report.num_candidates, 2U);
  EXPECT_EQ(report.candidates[0].fate, seam::RingFate::kChosen);
  EXPECT_EQ(report.candidates[1].fate, seam::RingFate::kEqual);
  EXPECT_TRUE(finder.points().empty());
}

TEST(SeamRefusal, of_two_equal_rings_a_region_chooses_one) {
  JointCloud both(paper_joint());
  both.transform(Eigen::Matrix3d::Identity(), Eigen::Vector3d(400.0, 0.0, 0.0), 1.0);
  const JointCloud first(paper_joint());
  const auto& points = first.view().points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    both.add({double{points.x[i]}, double{points.y[i]}, double{points.z[i]} + 200.0});
  }
  SeamInput in{.cloud_base = both.view()};
  in.region = RegionOfInterest{{-150.0, -150.0, 0.0}, {150.0, 150.0, 400.0}};
  SeamFinder finder;

  const SeamReport report = finder.find(in);

  EXPECT_TRUE(report.weld()) << name(report.refusal);
}

TEST(SeamRefusal, a_nozzle_that_hangs_above_its_shell_is_no_ring) {
  JointCloudConfig shell_alone = paper_joint();
  shell_alone.nozzle = false;
  JointCloudConfig nozzle_alone = paper_joint();
  nozzle_alone.shell_seen = false;
  JointCloud apart(shell_alone);
  const JointCloud nozzle(nozzle_alone);
  const auto& points = nozzle.view().points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    apart.add({double{points.x[i]}, double{points.y[i]}, double{points.z[i]} + 120.0});
  }
  SeamFinder finder;

  EXPECT_EQ(finder.find(apart).refusal, Refusal::kNoRing);
}

TEST(SeamRefusal, a_seam_less_certain_than_asked_for_is_named) {
  SeamFinder finder({.max_sigma_mm = 1e-4});

  EXPECT_EQ(finder.find(JointCloud(paper_joint())).refusal, Refusal::kUncertain);
}

// The shell begins farther from the joint than the nozzle does, and no edge is seen between them.
TEST(SeamRefusal, a_gap_that_nobody_saw_the_edge_of_is_too_uncertain_to_weld) {
  JointCloudConfig config = paper_joint();
  config.spacing_mm = 0.6;
  config.shell_reach_mm = 45.0;
  config.dead_band_mm = 2.1;
  config.gap_mm = 3.0;
  SeamFinder finder;

  const SeamReport report = finder.find(JointCloud(config));

  EXPECT_EQ(report.refusal, Refusal::kUncertain);
  EXPECT_FALSE(report.joint.has_gap);
  EXPECT_GE(report.joint.hidden_gap_mm, 2.0);
}

TEST(SeamRefusal, a_gap_that_sparse_points_hardly_show_is_not_welded_as_if_it_were_known) {
  for (const double spacing_mm : {1.0, 1.5, 2.0, 2.5, 3.0}) {
    for (const double gap_mm : {1.0, 2.0, 3.0}) {
      JointCloudConfig config = paper_joint();
      config.spacing_mm = spacing_mm;
      config.gap_mm = gap_mm;
      const JointCloud cloud(config);
      SeamFinder finder;

      const SeamReport report = finder.find(cloud);

      const double worst_mm = finder.worst_error(cloud.curve(1440, gap_mm));
      EXPECT_TRUE(!report.weld() || worst_mm < 3.0 * report.quality.max_sigma_lateral_mm)
          << spacing_mm << " mm apart, a gap of " << gap_mm << " mm: " << worst_mm << " mm off";
    }
  }
}

TEST(SeamRefusal, more_points_beside_the_joint_than_there_is_room_for_are_named) {
  const JointCloud cloud(paper_joint());
  const SeamChain::Capacity little{.max_points = 3000, .max_edge_intervals = 1000};
  test::ArenaOwner owner(SeamChain::bytes(little));
  SeamChain chain = SeamChain::make({}, little, owner.arena()).value();
  std::vector<seam::SeamPoint> storage(4096);
  Buffer<seam::SeamPoint> out{std::span<seam::SeamPoint>(storage)};

  EXPECT_EQ(chain.run(SeamInput{.cloud_base = cloud.view()}, out).refusal, Refusal::kFull);
}

TEST(SeamRefusal, a_full_output_is_named) {
  const JointCloud cloud(paper_joint());
  test::ArenaOwner owner(SeamChain::bytes({}));
  SeamChain chain = SeamChain::make({}, {}, owner.arena()).value();
  std::array<seam::SeamPoint, 100> storage;
  Buffer<seam::SeamPoint> out{std::span<seam::SeamPoint>(storage)};

  EXPECT_EQ(chain.run(SeamInput{.cloud_base = cloud.view()}, out).refusal, Refusal::kFull);
}

TEST(SeamRefusal, make_names_a_small_arena_and_a_bad_configuration) {
  std::array<std::byte, 1000> little{};
  Arena arena(little);
  test::ArenaOwner owner(SeamChain::bytes({}));

  EXPECT_EQ(SeamChain::make({}, {}, arena).error(), Errc::kOutOfMemory);
  EXPECT_EQ(SeamChain::make({.point_spacing_mm = -1.0}, {}, owner.arena()).error(),
            Errc::kInvalidArgument);
}

}  // namespace
}  // namespace dseam::pipeline
