// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace dseam::torch {

/// Cubic Hermite segment of unit parameter: position and derivative.
struct Hermite {
  Eigen::Vector3d p0, d0, p1, d1;

  Eigen::Vector3d at(double u) const noexcept {
    const double v = 1.0 - u;
    return v * v * (1.0 + 2.0 * u) * p0 + u * v * v * d0 + u * u * (1.0 + 2.0 * v) * p1 -
           u * u * v * d1;
  }
  Eigen::Vector3d slope(double u) const noexcept {
    const double v = 1.0 - u;
    return 6.0 * u * v * (p1 - p0) + v * (1.0 - 3.0 * u) * d0 + u * (3.0 * u - 2.0) * d1;
  }
  /// Arc length of [0, u] by four-point Gauss-Legendre quadrature.
  double length(double u) const noexcept {
    constexpr double kNode[] = {0.3399810435848563, 0.8611363115940526};
    constexpr double kWeight[] = {0.6521451548625461, 0.3478548451374538};
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
      sum += kWeight[i] *
             (slope(0.5 * u * (1.0 - kNode[i])).norm() + slope(0.5 * u * (1.0 + kNode[i])).norm());
    }
    return 0.5 * u * sum;
  }
  /// The parameter at which the length is `target_mm`.
  double parameter_at(double target_mm, double total_mm) const noexcept {
    double u = std::clamp(target_mm / total_mm, 0.0, 1.0);
    for (int i = 0; i < 4; ++i) {
      u = std::clamp(u - (length(u) - target_mm) / slope(u).norm(), 0.0, 1.0);
    }
    return u;
  }
};

}  // namespace dseam::torch
