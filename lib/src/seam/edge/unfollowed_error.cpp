// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/unfollowed_error.hpp"

namespace dseam::seam {

void UnfollowedError::reset(std::size_t order) noexcept {
  order_ = order;
  count_ = 0.0;
  sums_ = {};
}

void UnfollowedError::add(double phi_rad, const ResidualModel::Row& errors) noexcept {
  const EdgeCurve::Vector basis = EdgeCurve::basis_at(phi_rad);
  for (std::size_t i = 0; i < order_; ++i) {
    for (std::size_t k = 0; k < errors.size(); ++k) {
      sums_[i][k] += basis[i] * errors[k];
    }
  }
  count_ += 1.0;
}

// Round the turn the harmonics are square to each other: the mean square of a wave is a half.
double UnfollowedError::variance_at(double phi_rad,
                                    const ResidualModel::Row& errors) const noexcept {
  const EdgeCurve::Vector basis = EdgeCurve::basis_at(phi_rad);
  double variance = 0.0;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    double rest = errors[k];
    for (std::size_t i = 0; i < order_; ++i) {
      rest -= basis[i] * sums_[i][k] * (i == 0 ? 1.0 : 2.0) / count_;
    }
    variance += rest * rest;
  }
  return variance;
}

}  // namespace dseam::seam
