// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/dense_solver.hpp"

#include <cmath>

namespace dseam::seam {

bool LentSymmetric::factorise() noexcept {
  for (std::size_t j = 0; j < order_; ++j) {
    for (std::size_t i = j; i < order_; ++i) {
      double sum = at(i, j);
      for (std::size_t k = 0; k < j; ++k) {
        sum -= at(i, k) * at(j, k);
      }
      if (i == j && !(sum > 0.0)) {
        return false;
      }
      at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
    }
  }
  return true;
}

void LentSymmetric::forward(std::span<double> x) const noexcept {
  for (std::size_t i = 0; i < order_; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      x[i] -= at(i, k) * x[k];
    }
    x[i] /= at(i, i);
  }
}

void LentSymmetric::solve(std::span<double> x) const noexcept {
  forward(x);
  for (std::size_t i = order_; i-- > 0;) {
    for (std::size_t k = i + 1; k < order_; ++k) {
      x[i] -= at(k, i) * x[k];
    }
    x[i] /= at(i, i);
  }
}

}  // namespace dseam::seam
