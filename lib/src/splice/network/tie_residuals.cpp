// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/tie_residuals.hpp"

#include <algorithm>

namespace dseam::splice {

std::size_t facing_of(double cosine) noexcept {
  constexpr std::array<double, kFacings - 1> kLimits{0.55, 0.75, 0.9};
  return static_cast<std::size_t>(
      std::count_if(kLimits.begin(), kLimits.end(), [&](double limit) { return cosine > limit; }));
}

void TieResiduals::add(const TieResiduals& other) noexcept {
  const auto merge = [](Mean& a, const Mean& b) {
    a.sum += b.sum;
    a.count += b.count;
  };
  merge(same_, other.same_);
  for (std::size_t way = 0; way < apart_.size(); ++way) {
    for (std::size_t lag = 0; lag < kLags; ++lag) {
      merge(apart_[way][lag], other.apart_[way][lag]);
    }
  }
}

// Shares are as often below zero as above where nothing hangs together: only their sum is bounded.
double TieResiduals::ties_per_independent() const noexcept {
  double product = 1.0;
  for (const auto& way : apart_) {
    double along = 1.0;
    for (const Mean& pair : way) {
      along += same_.sum > 0.0 ? 2.0 * pair.mean() / same_.mean() : 0.0;
    }
    product *= std::max(1.0, along);
  }
  return product;
}

void ResidualTrail::push(double residual, bool known, bool down, TieResiduals& to) noexcept {
  if (known) {
    to.add(residual);
    for (std::size_t k = 0; k < last_.size(); ++k) {
      if (known_[k]) {
        to.add_pair(residual, last_[k], k + 1, down);
      }
    }
  }
  last_ = {residual, last_[0], last_[1]};
  known_ = {known, known_[0], known_[1]};
}

}  // namespace dseam::splice
