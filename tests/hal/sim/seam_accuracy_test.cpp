// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/seam_accuracy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "dseam/hal/sim/cell.hpp"

namespace dseam::test {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;

hal::sim::Cell default_cell() { return hal::sim::Cell::make({}).value(); }

std::vector<seam::SeamPoint> points_of(const hal::sim::TruthCurve& truth, double out_mm,
                                       double up_mm) {
  std::vector<seam::SeamPoint> points;
  for (const hal::sim::TruthPoint& at : truth.points) {
    seam::SeamPoint point;
    Vector3d outwards = at.tangent.cross(at.n_shell).normalized();
    outwards = outwards.dot(at.n_nozzle) < 0.0 ? Vector3d(-outwards) : outwards;
    point.p_base = at.p + out_mm * outwards + up_mm * at.n_shell;
    point.source = seam::Source::kMeasured;
    points.push_back(point);
  }
  return points;
}

TEST(SeamAccuracy, a_shifted_seam_has_its_shift_as_error_split_into_lateral_and_normal) {
  const auto truth = *default_cell().seam();

  const SeamAccuracy accuracy = measure_seam(points_of(truth, 0.3, -0.4), truth, {});

  EXPECT_NEAR(accuracy.rmse_mm, 0.5, 2e-3);
  EXPECT_NEAR(accuracy.max_mm, 0.5, 2e-2);
  EXPECT_NEAR(accuracy.points[100].lateral_mm, 0.3, 5e-3);
  EXPECT_NEAR(accuracy.points[100].normal_mm, -0.4, 5e-3);
  EXPECT_EQ(accuracy.coverage, 1.0);
}

TEST(SeamAccuracy, only_measured_rows_cover) {
  const auto truth = *default_cell().seam();
  auto points = points_of(truth, 0.0, 0.0);
  for (std::size_t i = 0; i < points.size() / 4; ++i) {
    points[i].source = seam::Source::kInterpolated;
  }

  const SeamAccuracy accuracy = measure_seam(points, truth, {});

  EXPECT_NEAR(accuracy.coverage, 0.75, 0.01);
  EXPECT_LT(accuracy.max_mm, 1e-9);
  EXPECT_EQ(measure_measured(points, truth, {}).points.size(), points.size() - points.size() / 4);
}

TEST(BaseCorrection, an_error_common_to_all_views_is_removed) {
  const hal::sim::Cell cell = default_cell();
  const auto truth = *cell.seam();
  const RigidTransform shift{geometry::rotation_exp({0.01, -0.02, 0.03}), {1.0, 2.0, -3.0}};
  std::vector<ViewPoses> views;
  for (const auto& view : cell.views()) {
    views.push_back({view.T_base_camera, shift * view.T_base_camera});
  }

  const RigidTransform correction = base_correction(views, truth);

  EXPECT_LT(geometry::difference(correction * shift, {}).norm(), 1e-9);
  EXPECT_LT(splice_error(views, truth).rms_mm, 1e-9);
}

TEST(SpliceError, one_view_out_of_six_that_is_off_spreads_the_images) {
  const hal::sim::Cell cell = default_cell();
  const auto truth = *cell.seam();
  std::vector<ViewPoses> views;
  for (const auto& view : cell.views()) {
    views.push_back({view.T_base_camera, view.T_base_camera});
  }
  views[2].adjusted.translation_mm.x() += 0.6;

  const SpliceError error = splice_error(views, truth);

  // Distances from the mean: 0.5 once and 0.1 five times.
  EXPECT_NEAR(error.rms_mm, std::sqrt((0.25 + 5 * 0.01) / 6.0), 1e-9);
}

TEST(Quantile, is_interpolated_between_the_values_around_it) {
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_EQ(quantile({}, 0.5), 0.0);
}

}  // namespace
}  // namespace dseam::test
