// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "spliced_scan.hpp"
#include "support/arena_owner.hpp"

namespace dseam::pipeline {
namespace {

using splice::NetworkState;
using splice::ViewState;
using test::bare_scan;
using test::marked_scan;
using test::Scan;
using test::splice_all;
using test::splice_error_mm;
using test::Spliced;

/// The default nozzle's shell with another nozzle, at another angle.
const Scan& other_part() {
  static const Scan kScan = [] {
    hal::sim::CellConfig config;
    config.markers.count = 0;
    config.joint.shell_radius_mm = 150.0;
    config.joint.nozzle_radius_mm = 35.0;
    config.joint.axis_angle_rad = 1.1;
    return test::scan(config);
  }();
  return kScan;
}

/// The default part with its markers stuck elsewhere.
const Scan& other_markers() {
  static const Scan kScan = [] {
    hal::sim::CellConfig config;
    config.seed = 77;
    config.views.jitter_mm = 0.0;
    return test::scan(config);
  }();
  return kScan;
}

/// A shell that is seen nowhere but on its side.
const Scan& bare_pipe() {
  static const Scan kScan = [] {
    hal::sim::CellConfig config;
    config.markers.count = 0;
    config.joint.kind = hal::sim::JointKind::kShellOnly;
    config.joint.shell_length_mm = 900.0;
    config.views.count = 3;
    config.views.azimuth_span_rad = 1.5;
    return test::scan(config);
  }();
  return kScan;
}

std::size_t num_in(const Spliced& spliced, ViewState state) {
  return static_cast<std::size_t>(std::count_if(spliced.views.begin(), spliced.views.end(),
                                                [&](const auto& v) { return v.state == state; }));
}

TEST(SpliceBadInput, a_view_of_another_part_is_left_out_by_name) {
  std::vector<depth::DepthImage> frames = bare_scan().frames;
  frames[2] = other_part().frames[2];

  const Spliced spliced = splice_all(frames, bare_scan().reported);

  EXPECT_EQ(spliced.views[2].state, ViewState::kContradicts);
  EXPECT_EQ(spliced.report.num_used, 5U);
  EXPECT_LT(splice_error_mm(bare_scan(), spliced), 0.03);
}

TEST(SpliceBadInput, of_two_views_that_disagree_neither_is_believed) {
  const std::vector<depth::DepthImage> frames = {bare_scan().frames[0], other_part().frames[1]};

  const Spliced spliced = splice_all(frames, std::span(bare_scan().reported).first(2));

  EXPECT_EQ(num_in(spliced, ViewState::kContradicts), 2U);
  EXPECT_EQ(spliced.report.state, NetworkState::kNoViews);
}

TEST(SpliceBadInput, without_markers_and_reports_only_the_first_view_stands) {
  const Spliced spliced = splice_all(bare_pipe().frames, {});

  EXPECT_EQ(num_in(spliced, ViewState::kNoOverlap), 2U);
  EXPECT_EQ(spliced.report.state, NetworkState::kOneView);
}

TEST(SpliceBadInput, views_that_can_slide_along_a_pipe_are_not_taken_for_spliced) {
  const Spliced spliced = splice_all(bare_pipe().frames, bare_pipe().reported);

  EXPECT_EQ(num_in(spliced, ViewState::kUnobservable), 2U);
  EXPECT_EQ(spliced.report.state, NetworkState::kOneView);
}

TEST(SpliceBadInput, a_first_frame_without_depth_costs_that_view_alone) {
  std::vector<depth::DepthImage> frames = marked_scan().frames;
  const std::vector<std::uint16_t> nothing(frames[0].depth.size(), 0);
  const std::vector<std::uint8_t> dark(frames[0].gray.size(), 0);
  frames[0].depth = nothing;
  frames[0].gray = dark;

  const Spliced spliced = splice_all(frames, {});

  EXPECT_EQ(spliced.views[0].state, ViewState::kEmpty);
  EXPECT_EQ(spliced.report.num_used, 5U);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
}

TEST(SpliceBadInput, a_first_view_that_no_other_hangs_on_costs_that_view_alone) {
  std::vector<depth::DepthImage> frames = marked_scan().frames;
  frames[0] = other_part().frames[0];

  const Spliced spliced = splice_all(frames, {});

  EXPECT_EQ(spliced.views[0].state, ViewState::kNoOverlap);
  EXPECT_EQ(spliced.report.num_used, 5U);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
}

TEST(SpliceBadInput, a_first_view_of_another_part_leaves_the_others_their_markers) {
  std::vector<depth::DepthImage> frames = marked_scan().frames;
  frames[0] = other_part().frames[0];

  const Spliced spliced = splice_all(frames, marked_scan().reported);

  EXPECT_NE(spliced.views[0].state, ViewState::kUsed);
  EXPECT_GE(spliced.report.num_markers, 12U);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
}

TEST(SpliceBadInput, markers_that_were_moved_do_not_bend_the_views) {
  std::vector<depth::DepthImage> frames = marked_scan().frames;
  std::vector<splice::ReportedPose> reported = marked_scan().reported;
  Scan mixed = marked_scan();
  frames[3] = other_markers().frames[3];
  reported[3] = other_markers().reported[3];
  mixed.truth[3] = other_markers().truth[3];

  const Spliced spliced = splice_all(frames, reported);

  EXPECT_LT(splice_error_mm(mixed, spliced), 0.03);
}

TEST(SpliceBadInput, poses_in_metres_are_named) {
  std::vector<splice::ReportedPose> reported = marked_scan().reported;
  for (splice::ReportedPose& pose : reported) {
    pose.T_base_camera.translation_mm *= 1e-3;
  }

  const Spliced spliced = splice_all(marked_scan().frames, reported);

  const auto rejected = std::count_if(spliced.views.begin(), spliced.views.end(),
                                      [](const auto& v) { return v.reported_pose_rejected; });
  EXPECT_GE(rejected, 5);
}

TEST(SpliceBadInput, a_reported_pose_that_is_not_rigid_counts_as_none) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<splice::ReportedPose> bad(4, marked_scan().reported[0]);
  bad[0].T_base_camera.translation_mm.x() = nan;
  bad[1].T_base_camera.rotation(1, 2) = nan;
  bad[2].T_base_camera.rotation *= 1.01;
  bad[3].T_base_camera.rotation.col(0) *= -1.0;
  const SpliceChain::Capacity capacity;
  test::ArenaOwner owner(SpliceChain::bytes(capacity));
  auto chain = SpliceChain::make({}, capacity, owner.arena());

  for (const splice::ReportedPose& pose : bad) {
    chain.value().clear();

    EXPECT_TRUE(chain.value().add(marked_scan().frames[0], pose).reported_refused);
  }
}

}  // namespace
}  // namespace dseam::pipeline
