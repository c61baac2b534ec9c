// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/mean_sight.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace dseam::seam {
namespace {

using Eigen::Vector3d;

// On a shell that faces +z, a nozzle's wall that faces +x; the curve runs along y.
SeamPoint upright_joint() {
  SeamPoint point;
  point.p_base = Vector3d(10.0, 20.0, 30.0);
  point.tangent = Vector3d::UnitY();
  point.n_shell = Vector3d::UnitZ();
  point.n_nozzle = Vector3d::UnitX();
  return point;
}

Vector3d from(const Vector3d& direction) { return upright_joint().p_base + 500.0 * direction; }

TEST(MeanSight, of_one_viewpoint_is_the_direction_to_it) {
  const std::array viewpoints{from({0.6, 0.0, 0.8})};

  const MeanSight sight = mean_sight(viewpoints, upright_joint());

  EXPECT_NEAR(sight.lateral, 0.6, 1e-12);
  EXPECT_NEAR(sight.normal, 0.8, 1e-12);
  EXPECT_NEAR(sight.slant(), 0.75, 1e-12);
}

TEST(MeanSight, leaves_out_who_looks_at_the_nozzles_other_side_or_from_under_the_shell) {
  const std::array viewpoints{from({0.6, 0.0, 0.8}), from({-0.6, 0.0, 0.8}),
                              from({0.6, 0.0, -0.8})};

  const MeanSight sight = mean_sight(viewpoints, upright_joint());

  EXPECT_NEAR(sight.lateral, 0.6, 1e-12);
  EXPECT_NEAR(sight.normal, 0.8, 1e-12);
}

TEST(MeanSight, goes_by_how_squarely_the_wall_is_seen) {
  const std::array viewpoints{from({0.8, 0.0, 0.6}), from({0.2, std::sqrt(0.6), 0.6})};

  const MeanSight sight = mean_sight(viewpoints, upright_joint());

  EXPECT_NEAR(sight.lateral, (0.8 * 0.8 + 0.2 * 0.2) / (0.8 + 0.2), 1e-12);
  EXPECT_NEAR(sight.normal, 0.6, 1e-12);
}

TEST(MeanSight, is_the_same_whichever_way_the_curve_runs) {
  const std::array viewpoints{from({0.6, 0.0, 0.8})};
  SeamPoint back = upright_joint();
  back.tangent = -back.tangent;

  EXPECT_NEAR(mean_sight(viewpoints, back).lateral, 0.6, 1e-12);
}

TEST(MeanSight, of_no_viewpoint_is_any_direction) {
  const MeanSight sight = mean_sight({}, upright_joint());

  EXPECT_EQ(sight.lateral, 1.0);
  EXPECT_EQ(sight.normal, 1.0);
}

}  // namespace
}  // namespace dseam::seam
