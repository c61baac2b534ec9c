// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/chi_squared.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

namespace dseam::test {
namespace {

/// The regularised lower incomplete gamma function by its power series.
double lower_gamma(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < 1000 && term > 1e-16 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(a * std::log(x) - x - std::lgamma(a));
}

}  // namespace

double chi_squared_quantile(double probability, int dof) {
  double low = 0.0;
  double high = 20.0 * dof + 100.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (lower_gamma(0.5 * dof, 0.5 * middle) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void NeesTally::add(double nees, int dof) {
  ++count_;
  inside_ += nees < chi_squared_quantile(0.95, dof);
  sum_ratio_ += nees / dof;
}

void NeesTally::add(const geometry::Vector6& error, const geometry::Matrix6& covariance) {
  const Eigen::LLT<geometry::Matrix6> factor(covariance);
  const bool definite = factor.info() == Eigen::Success;
  add(definite ? error.dot(factor.solve(error)) : std::numeric_limits<double>::infinity(), 6);
}

double NeesTally::share_inside() const noexcept {
  return count_ == 0 ? 0.0 : static_cast<double>(inside_) / count_;
}

double NeesTally::mean_ratio() const noexcept { return count_ == 0 ? 0.0 : sum_ratio_ / count_; }

}  // namespace dseam::test
