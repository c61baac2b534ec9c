// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

namespace dseam::seam {

/// A smooth function of the place along an open seam, and of the distance from it, by least
/// squares: a polynomial along, constant, linear and square away. The Bayesian information
/// criterion says how high an order the samples justify.
///
/// Units:   `along` is -1 at the seam's start and 1 at its end; `away` is 0 at the seam.
/// Time:    O(samples).
class AlongModel {
 public:
  static constexpr int kMaxOrder = 4;
  static constexpr int kColumns = kMaxOrder + 4;
  struct Sample {
    double along = 0.0;
    double away = 0.0;
    double value = 0.0;
    double weight = 1.0;
  };

  /// `uses_away`: false where all samples lie at the seam. False, and 0 everywhere, where there are
  /// too few samples.
  bool fit(std::span<const Sample> samples, bool uses_away) noexcept;

  [[nodiscard]] bool fitted() const noexcept { return fitted_; }
  [[nodiscard]] int order() const noexcept { return terms_.order; }
  [[nodiscard]] double at(double along, double away = 0.0) const noexcept;
  /// Of at(), by the scatter of the samples.
  [[nodiscard]] double variance_at(double along) const noexcept;

 private:
  using Row = Eigen::Matrix<double, kColumns, 1>;
  using Square = Eigen::Matrix<double, kColumns, kColumns>;

  struct Terms {
    int order = 0;
    int away = 0;  // 0: none; 1: linear; 2: its square as well.
    [[nodiscard]] int count() const noexcept { return order + 1 + (away > 0 ? away + 1 : 0); }
  };

  [[nodiscard]] static Row row_at(double along, double away, const Terms& terms) noexcept;
  double solve(std::span<const Sample> samples, const Terms& terms) noexcept;

  bool fitted_ = false;
  Terms terms_;
  Row coefficients_ = Row::Zero();
  Square covariance_ = Square::Zero();
};

}  // namespace dseam::seam
