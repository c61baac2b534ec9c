// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/symmetric_matrix.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "dseam/base/random.hpp"

namespace {

using Matrix6 = dseam::geometry::SquareMatrix<6>;

Matrix6 random_positive(dseam::Pcg32& random) {
  Matrix6 m;
  for (int i = 0; i < 36; ++i) {
    m(i) = random.uniform() - 0.5;
  }
  return m * m.transpose();
}

TEST(SymmetricMatrix, eigenvalues_and_vectors_are_those_of_eigen) {
  dseam::Pcg32 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix6 matrix = random_positive(random);
    const Eigen::SelfAdjointEigenSolver<Matrix6> truth(matrix);

    const auto eigen = dseam::geometry::eigen_of_symmetric<6>(matrix);

    EXPECT_LT((eigen.values - truth.eigenvalues()).norm(), 1e-12 * matrix.norm());
    EXPECT_LT((matrix * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(),
              1e-12 * matrix.norm());
    EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - Matrix6::Identity()).norm(), 1e-13);
  }
}

TEST(SymmetricMatrix, values_over_ten_decades_keep_their_digits) {
  dseam::geometry::SquareMatrix<5> matrix;
  matrix.setZero();
  matrix.diagonal() << 1e-4, 1e6, 1.0, 3.0, 1e-4;
  matrix(0, 4) = matrix(4, 0) = 5e-5;

  const auto eigen = dseam::geometry::eigen_of_symmetric<5>(matrix);

  EXPECT_NEAR(eigen.values(0), 5e-5, 1e-18);
  EXPECT_NEAR(eigen.values(1), 1.5e-4, 1e-18);
  EXPECT_EQ(eigen.values(4), 1e6);
}

TEST(SymmetricMatrix, the_inverse_times_the_matrix_is_the_identity) {
  dseam::Pcg32 random(8);
  const Matrix6 matrix = random_positive(random);

  const Matrix6 inverse = dseam::geometry::inverse_of_symmetric<6>(matrix);

  EXPECT_LT((inverse * matrix - Matrix6::Identity()).norm(), 1e-9);
}

TEST(SymmetricMatrix, what_is_not_finite_ends_and_stays_not_finite) {
  Matrix6 matrix = Matrix6::Identity();
  matrix(1, 2) = matrix(2, 1) = std::numeric_limits<double>::quiet_NaN();

  const auto eigen = dseam::geometry::eigen_of_symmetric<6>(matrix);

  EXPECT_FALSE(eigen.values.allFinite());
}

}  // namespace
