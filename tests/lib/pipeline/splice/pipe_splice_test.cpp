// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <vector>

#include "dseam/splice/pipes/pipe_match.hpp"
#include "spliced_scan.hpp"
#include "support/accuracy/seam_accuracy.hpp"
#include "support/arena_owner.hpp"

namespace dseam::pipeline {
namespace {

using splice::PipePlacer;
using splice::ViewState;
using test::bare_scan;
using test::Scan;
using test::splice_all;
using test::splice_error_mm;
using test::Spliced;

hal::sim::CellConfig oblique_cell() {
  hal::sim::CellConfig config;
  config.markers.count = 0;
  config.joint.axis_angle_rad = 1.3;
  config.joint.eccentricity_mm = 10.0;
  return config;
}

/// A part without any symmetry, and without markers.
const Scan& oblique_scan() {
  static const Scan kScan = test::scan(oblique_cell());
  return kScan;
}

std::vector<splice::ReportedPose> far_off(std::vector<splice::ReportedPose> reported,
                                          std::size_t view) {
  geometry::RigidTransform& T = reported[view].T_base_camera;
  T.rotation =
      geometry::rotation_exp(8.0 * std::numbers::pi / 180.0 * Eigen::Vector3d(0.6, -0.48, 0.64)) *
      T.rotation;
  T.translation_mm += 30.0 * Eigen::Vector3d(0.36, 0.8, -0.48);
  return reported;
}

void expect_placed_and_named(const Scan& scan, std::size_t view) {
  const Spliced spliced = splice_all(scan.frames, far_off(scan.reported, view));

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(scan, spliced), 0.03);
  for (std::size_t v = 0; v < spliced.views.size(); ++v) {
    EXPECT_EQ(spliced.views[v].reported_pose_rejected, v == view);
  }
}

splice::PipePair pipes_in(const depth::DepthImage& frame) {
  const depth::Intrinsics& k = frame.intrinsics;
  std::vector<splice::SurfacePatch> patches(splice::PatchField::size_for(k.width, k.height));
  (void)splice::PatchExtractor({}).run(frame, {}, patches);
  constexpr std::uint32_t kBlock = splice::PatchField::kBlockPx;
  test::ArenaOwner owner(splice::PipeFinder::bytes());
  auto finder = splice::PipeFinder::make({}, owner.arena());
  return finder.value().run({k, k.width / kBlock, k.height / kBlock, patches});
}

/// Of the pose between views a and b, at the true seam.
double relative_error_mm(const Scan& scan, std::size_t a, std::size_t b,
                         const geometry::RigidTransform& T_a_b) {
  const std::vector<test::ViewPoses> poses = {{scan.truth[a], scan.truth[a]},
                                              {scan.truth[b], scan.truth[a] * T_a_b}};
  return 2.0 * test::splice_error(poses, scan.seam).rms_mm;
}

// Why the pair is a start and a check, and no observation beside the surfaces.
TEST(PipeSplice, pipes_alone_tell_a_pose_to_a_tenth_and_surfaces_better) {
  const Spliced spliced = splice_all(oblique_scan().frames, oblique_scan().reported);
  std::vector<double> by_pipes;
  std::vector<double> by_ties;
  for (std::size_t a = 0; a < 6; ++a) {
    const std::size_t b = (a + 1) % 6;
    const auto places = splice::match_pipes(pipes_in(oblique_scan().frames[a]),
                                            pipes_in(oblique_scan().frames[b]), 0.01);
    const auto& place = places.places[places.possible(0) ? 0 : 1];
    by_pipes.push_back(relative_error_mm(oblique_scan(), a, b, place.T_a_b));
    by_ties.push_back(relative_error_mm(
        oblique_scan(), a, b,
        spliced.views[a].T_base_camera.inverse() * spliced.views[b].T_base_camera));
  }

  const double pipes_mm = test::quantile(by_pipes, 0.5);
  const double ties_mm = test::quantile(by_ties, 0.5);
  std::printf(
      "six pairs of neighbours, error at the seam: pipes alone median %.3f worst %.3f mm, "
      "all views' ties median %.3f worst %.3f mm\n",
      pipes_mm, test::quantile(by_pipes, 1.0), ties_mm, test::quantile(by_ties, 1.0));
  EXPECT_LT(test::quantile(by_pipes, 1.0), 0.3);
  EXPECT_LT(ties_mm, pipes_mm);
}

TEST(PipeSplice, a_view_along_the_nozzle_is_placed_by_its_bore) {
  hal::sim::CellConfig config = oblique_cell();
  config.seed = 8;
  config.joint.axis_angle_rad = 1.06;
  config.joint.nozzle_radius_mm = 51.0;
  const Scan scan = test::scan(config);
  const splice::PipePair along = pipes_in(scan.frames[0]);

  const Spliced spliced = splice_all(scan.frames, {});

  EXPECT_FALSE(along.nozzle.usable);
  EXPECT_TRUE(along.bore.usable);
  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(scan, spliced), 0.03);
}

TEST(PipeSplice, without_markers_and_reports_the_pipes_place_every_view) {
  const Spliced spliced = splice_all(oblique_scan().frames, {});

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_FALSE(spliced.report.has_base);
  EXPECT_LT(splice_error_mm(oblique_scan(), spliced), 0.03);
  EXPECT_LT(geometry::difference(spliced.views[0].T_base_camera, {}).norm(), 1e-3);
}

TEST(PipeSplice, an_oval_part_is_placed_as_well) {
  hal::sim::CellConfig config = oblique_cell();
  config.seed = 31;
  config.joint.shell_radius_mm = 140.0;
  config.joint.nozzle_radius_mm = 45.0;
  config.joint.shell_ovality_mm = 0.3;
  config.joint.nozzle_ovality_mm = 0.3;
  config.joint.nozzle_ovality_angle_rad = 0.7;
  const Scan oval = test::scan(config);

  const Spliced spliced = splice_all(oval.frames, {});

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(oval, spliced), 0.10);
}

TEST(PipeSplice, a_view_without_a_report_among_others_is_placed) {
  std::vector<splice::ReportedPose> reported = oblique_scan().reported;
  reported[3] = {};

  const Spliced spliced = splice_all(oblique_scan().frames, reported);

  EXPECT_EQ(spliced.report.num_used, 6U);
  EXPECT_LT(splice_error_mm(oblique_scan(), spliced), 0.03);
}

TEST(PipeSplice, a_report_that_is_far_off_is_named_and_its_view_placed) {
  expect_placed_and_named(oblique_scan(), 2);
}

TEST(PipeSplice, the_first_report_may_be_far_off_as_well) {
  expect_placed_and_named(oblique_scan(), 0);
}

TEST(PipeSplice, of_a_symmetric_part_a_report_that_is_far_off_tells_the_side) {
  expect_placed_and_named(bare_scan(), 4);
}

TEST(PipeSplice, a_symmetric_part_without_reports_fits_in_several_places_and_is_not_placed) {
  const Spliced spliced = splice_all(bare_scan().frames, {});

  EXPECT_EQ(spliced.report.state, splice::NetworkState::kOneView);
  EXPECT_EQ(std::count_if(spliced.views.begin(), spliced.views.end(),
                          [](const auto& v) { return v.state == ViewState::kAmbiguous; }),
            5);
}

TEST(PipeSplice, pipes_are_not_sought_where_the_reports_hold) {
  const SpliceChain::Capacity capacity;
  test::ArenaOwner owner(SpliceChain::bytes(capacity));
  auto chain = SpliceChain::make({}, capacity, owner.arena());
  for (std::size_t v = 0; v < bare_scan().frames.size(); ++v) {
    const auto report = chain.value().add(bare_scan().frames[v], bare_scan().reported[v]);

    EXPECT_EQ(report.pipes.state, PipePlacer::State::kNotSought);
  }
}

}  // namespace
}  // namespace dseam::pipeline
