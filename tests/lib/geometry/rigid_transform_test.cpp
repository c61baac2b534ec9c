// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/rigid_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace dseam::geometry {
namespace {

std::array<double, 16> with_rotation(const Eigen::Matrix3d& rotation) {
  return to_row_major({rotation, Eigen::Vector3d(1.0, 2.0, 3.0)});
}

TEST(RigidTransform, a_transform_times_its_inverse_is_the_identity) {
  const RigidTransform t{rotation_exp({0.3, -0.2, 1.1}), {10.0, -5.0, 400.0}};

  const Vector6 rest = difference(t * t.inverse(), RigidTransform{});

  EXPECT_LT(rest.norm(), 1e-12);
}

TEST(RigidTransform, difference_undoes_perturbed) {
  const RigidTransform t{rotation_exp({0.3, -0.2, 1.1}), {10.0, -5.0, 400.0}};
  Vector6 delta;
  delta << 0.5, -0.25, 2.0, 0.01, -0.02, 0.5;

  EXPECT_LT((difference(perturbed(t, delta), t) - delta).norm(), 1e-12);
}

TEST(RigidTransform, log_undoes_exp_from_zero_to_nearly_a_half_turn) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  for (const double angle : {0.0, 1e-9, 1e-6, 1e-3, 1.0, 3.0, std::numbers::pi - 1e-6}) {
    EXPECT_LT((rotation_log(rotation_exp(angle * axis)) - angle * axis).norm(), 1e-9) << angle;
  }
}

TEST(RigidFromRowMajor, takes_a_rigid_matrix) {
  const Eigen::Matrix3d rotation = rotation_exp({0.1, 0.2, 0.3});

  const auto read = rigid_from_row_major(with_rotation(rotation));

  ASSERT_TRUE(read.ok());
  EXPECT_LT((read.value().rotation - rotation).norm(), 1e-12);
  EXPECT_EQ(read.value().translation_mm.z(), 3.0);
}

TEST(RigidFromRowMajor, refuses_the_matrix_of_the_papers_equation_16) {
  const std::array<double, 16> paper{0.649, -0.748, -0.137, -37.764, 0.748, 0.664, -0.139, -56.438,
                                     0.137, 0.139,  0.981,  -16.690, 0.0,   0.0,   0.0,    1.0};

  EXPECT_EQ(rigid_from_row_major(paper).error(), Errc::kBadData);
}

TEST(RigidFromRowMajor, refuses_scaled_left_handed_and_unfinished_matrices) {
  const Eigen::Matrix3d rotation = rotation_exp({0.1, 0.2, 0.3});
  Eigen::Matrix3d mirrored = rotation;
  mirrored.col(0) *= -1.0;
  auto not_finite = with_rotation(rotation);
  not_finite[3] = std::numeric_limits<double>::quiet_NaN();
  auto projective = with_rotation(rotation);
  projective[12] = 0.5;

  EXPECT_FALSE(rigid_from_row_major(with_rotation(1.001 * rotation)).ok());
  EXPECT_FALSE(rigid_from_row_major(with_rotation(mirrored)).ok());
  EXPECT_FALSE(rigid_from_row_major(not_finite).ok());
  EXPECT_FALSE(rigid_from_row_major(projective).ok());
}

}  // namespace
}  // namespace dseam::geometry
