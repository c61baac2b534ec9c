// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::test {

/// The value that a chi-squared variable of `dof` degrees of freedom stays below with
/// `probability`.
[[nodiscard]] double chi_squared_quantile(double probability, int dof);

/// Judges predicted covariances by the normalised error squared of independent runs: below the 95 %
/// quantile in 90 to 99 % of them.
class NeesTally {
 public:
  /// `nees` is e' C^-1 e of an error with `dof` components; one value from each independent scan.
  void add(double nees, int dof);
  /// As add(), for a pose error and its covariance; one that is not positive definite is outside.
  void add(const geometry::Vector6& error, const geometry::Matrix6& covariance);

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  [[nodiscard]] double share_inside() const noexcept;
  /// Mean of nees / dof: one where the covariance is right.
  [[nodiscard]] double mean_ratio() const noexcept;
  [[nodiscard]] bool passes() const noexcept {
    return share_inside() >= 0.90 && share_inside() <= 0.99;
  }

 private:
  std::uint32_t count_ = 0;
  std::uint32_t inside_ = 0;
  double sum_ratio_ = 0.0;
};

}  // namespace dseam::test
