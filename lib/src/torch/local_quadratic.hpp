// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace dseam::torch {

/// The parabola that fits vectors best around x = 0, weighted by 1 - x^2 on (-1, 1).
///
/// Source:  Cleveland 1979.
class LocalQuadratic {
 public:
  void add(double x, const Eigen::Vector3d& value) noexcept {
    const Eigen::Vector3d powers(1.0, x, x * x);
    const double weight = 1.0 - x * x;
    moments_ += weight * powers * powers.transpose();
    sums_ += weight * value * powers.transpose();
  }
  [[nodiscard]] Eigen::Vector3d value() const noexcept { return coefficient(0); }
  /// By x.
  [[nodiscard]] Eigen::Vector3d slope() const noexcept { return coefficient(1); }

 private:
  /// NaN where fewer than three different x were added.
  Eigen::Vector3d coefficient(int row) const noexcept {
    const double determinant = moments_.determinant();
    const double scale = moments_(0, 0) * moments_(0, 0) * moments_(0, 0);
    if (!(determinant > 1e-12 * scale)) {
      return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    return sums_ * moments_.inverse().col(row);
  }

  Eigen::Matrix3d moments_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d sums_ = Eigen::Matrix3d::Zero();
};

}  // namespace dseam::torch
