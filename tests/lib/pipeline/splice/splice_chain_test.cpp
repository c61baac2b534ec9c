// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/splice_chain.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "spliced_scan.hpp"

namespace dseam::pipeline {
namespace {

using test::bare_scan;
using test::marked_scan;
using test::splice_all;
using test::splice_error_mm;
using test::Spliced;

TEST(SpliceChain, views_with_markers_are_spliced_to_hundredths) {
  const Spliced spliced = splice_all(marked_scan().frames, marked_scan().reported);

  EXPECT_EQ(spliced.report.state, splice::NetworkState::kAdjusted);
  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_GE(spliced.report.num_markers, 12U);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
}

TEST(SpliceChain, bare_pipes_are_spliced_to_hundredths) {
  const Spliced spliced = splice_all(bare_scan().frames, bare_scan().reported);

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(bare_scan(), spliced), 0.03);
}

TEST(SpliceChain, markers_alone_place_the_views_when_no_pose_is_reported) {
  const Spliced spliced = splice_all(marked_scan().frames, {});

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_FALSE(spliced.report.has_base);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
  EXPECT_LT(geometry::difference(spliced.views[0].T_base_camera, {}).norm(), 1e-3);
}

TEST(SpliceChain, a_report_that_is_far_off_is_named_and_its_view_kept_by_its_markers) {
  std::vector<splice::ReportedPose> reported = marked_scan().reported;
  reported[0].T_base_camera.translation_mm += Eigen::Vector3d(80.0, -40.0, 25.0);

  const Spliced spliced = splice_all(marked_scan().frames, reported);

  EXPECT_TRUE(spliced.views[0].reported_pose_rejected);
  EXPECT_FALSE(spliced.views[1].reported_pose_rejected);
  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(marked_scan(), spliced), 0.03);
}

TEST(SpliceChain, the_same_frame_twice_is_named) {
  std::vector<depth::DepthImage> frames = bare_scan().frames;
  frames[3] = frames[2];

  const Spliced spliced = splice_all(frames, bare_scan().reported);

  EXPECT_EQ(spliced.views[3].state, splice::ViewState::kDuplicate);
  EXPECT_EQ(spliced.report.num_used, 5U);
}

TEST(SpliceChain, one_view_and_none_are_named) {
  const Spliced one =
      splice_all(std::span(bare_scan().frames).first(1), std::span(bare_scan().reported).first(1));
  const Spliced none = splice_all({}, {});

  EXPECT_EQ(one.report.state, splice::NetworkState::kOneView);
  EXPECT_EQ(one.report.num_used, 1U);
  EXPECT_EQ(none.report.state, splice::NetworkState::kNoViews);
}

TEST(SpliceChain, repeats_to_the_bit) {
  const Spliced a = splice_all(marked_scan().frames, marked_scan().reported);
  const Spliced b = splice_all(marked_scan().frames, marked_scan().reported);

  for (std::size_t v = 0; v < a.views.size(); ++v) {
    EXPECT_EQ(a.views[v].T_base_camera.rotation, b.views[v].T_base_camera.rotation);
    EXPECT_EQ(a.views[v].T_base_camera.translation_mm, b.views[v].T_base_camera.translation_mm);
  }
}

}  // namespace
}  // namespace dseam::pipeline
