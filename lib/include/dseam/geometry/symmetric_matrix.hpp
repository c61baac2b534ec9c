// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace dseam::geometry {

/// What Eigen does with symmetric matrices over 3x3 and with several right-hand sides holds a
/// branch that takes memory from a heap, though a fixed size never enters it. These do the same
/// without the branch, so that the library asks for no heap at all.

template <int N>
using SquareMatrix = Eigen::Matrix<double, N, N>;

/// Eigenvalues in rising order, and their unit vectors as columns in that order.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values;
  SquareMatrix<N> vectors = SquareMatrix<N>::Identity();
};

namespace detail {

/// Turns rows and columns `p` and `q` of `a` until a(p, q) is zero, and `vectors` with them.
template <int N>
void rotate_to_zero(int p, int q, SquareMatrix<N>& a, SquareMatrix<N>& vectors) noexcept {
  const double theta = (a(q, q) - a(p, p)) / (2.0 * a(p, q));
  const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::hypot(t, 1.0);
  const double s = t * c;
  for (int k = 0; k < N; ++k) {
    const double left = a(k, p);
    a(k, p) = c * left - s * a(k, q);
    a(k, q) = s * left + c * a(k, q);
  }
  for (int k = 0; k < N; ++k) {
    const double upper = a(p, k);
    a(p, k) = c * upper - s * a(q, k);
    a(q, k) = s * upper + c * a(q, k);
    const double first = vectors(k, p);
    vectors(k, p) = c * first - s * vectors(k, q);
    vectors(k, q) = s * first + c * vectors(k, q);
  }
  a(p, q) = 0.0;
  a(q, p) = 0.0;
}

template <int N>
void sort_rising(SymmetricEigen<N>& eigen) noexcept {
  for (int i = 0; i + 1 < N; ++i) {
    int least = i;
    for (int j = i + 1; j < N; ++j) {
      least = eigen.values(j) < eigen.values(least) ? j : least;
    }
    std::swap(eigen.values(i), eigen.values(least));
    eigen.vectors.col(i).swap(eigen.vectors.col(least));
  }
}

}  // namespace detail

/// Decomposes a symmetric matrix by cyclic Jacobi rotations.
///
/// Time:    at most 16 sweeps of O(N^3); about six are used.
/// Errors:  a matrix that is not finite gives values that are not finite.
template <int N>
[[nodiscard]] SymmetricEigen<N> eigen_of_symmetric(SquareMatrix<N> a) noexcept {
  constexpr int kMaxSweeps = 16;
  constexpr double kNegligible = 1e-20;
  SymmetricEigen<N> eigen;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double off = 0.0;
    for (int p = 0; p < N; ++p) {
      for (int q = p + 1; q < N; ++q) {
        off = std::max(off, std::abs(a(p, q)));
        if (a(p, q) != 0.0) {
          detail::rotate_to_zero<N>(p, q, a, eigen.vectors);
        }
      }
    }
    if (!(off > kNegligible * a.diagonal().cwiseAbs().maxCoeff())) {
      break;
    }
  }
  eigen.values = a.diagonal();
  detail::sort_rising<N>(eigen);
  return eigen;
}

/// The solution for each column of `right`, one after another.
template <typename Factor, int N>
[[nodiscard]] SquareMatrix<N> solve_columns(const Factor& factor,
                                            const SquareMatrix<N>& right) noexcept {
  SquareMatrix<N> solution;
  for (int column = 0; column < N; ++column) {
    const Eigen::Matrix<double, N, 1> one = right.col(column);
    solution.col(column) = factor.solve(one);
  }
  return solution;
}

/// The inverse of a symmetric positive semi-definite matrix; that of a singular one means nothing.
template <int N>
[[nodiscard]] SquareMatrix<N> inverse_of_symmetric(const SquareMatrix<N>& matrix) noexcept {
  const Eigen::LDLT<SquareMatrix<N>> factor(matrix);
  return solve_columns(factor, SquareMatrix<N>(SquareMatrix<N>::Identity()));
}

}  // namespace dseam::geometry
