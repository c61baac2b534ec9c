// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/observability.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::splice {
namespace {

using geometry::Matrix6;
using geometry::Vector6;

Vector6 scale_of(double reach_mm) noexcept {
  Vector6 s;
  s << 1.0, 1.0, 1.0, 1.0 / reach_mm, 1.0 / reach_mm, 1.0 / reach_mm;
  return s;
}

}  // namespace

Observability find_frozen(const Matrix6& h, double sum_weight, double reach_mm,
                          double min_sensitivity) noexcept {
  Observability out;
  out.reach_mm = reach_mm;
  const Vector6 s = scale_of(reach_mm);
  const Matrix6 scaled = s.asDiagonal() * h * s.asDiagonal() / std::max(sum_weight, 1e-300);
  const auto eigen = geometry::eigen_of_symmetric<6>(scaled);
  out.directions = eigen.vectors;
  out.sensitivity = eigen.values;
  for (Eigen::Index i = 0; i < 6; ++i) {
    out.num_frozen += out.sensitivity(i) < min_sensitivity ? 1U : 0U;
  }
  return out;
}

Vector6 Observability::solve(const Matrix6& h, const Vector6& g) const noexcept {
  constexpr double kNoVariance = 0.0;
  return -(invert(h, kNoVariance) * g);
}

// In the basis of directions the frozen rows are replaced by those of the identity.
Matrix6 Observability::invert(const Matrix6& h, double frozen_variance) const noexcept {
  const Vector6 s = scale_of(reach_mm);
  const Matrix6 basis = s.asDiagonal() * directions;
  Matrix6 reduced = basis.transpose() * h * basis;
  const auto frozen = static_cast<Eigen::Index>(num_frozen);
  reduced.topRows(frozen).setZero();
  reduced.leftCols(frozen).setZero();
  reduced.diagonal().head(frozen).setOnes();
  Matrix6 inverse = geometry::inverse_of_symmetric<6>(reduced);
  inverse.diagonal().head(frozen).setConstant(frozen_variance);
  return basis * inverse * basis.transpose();
}

}  // namespace dseam::splice
