// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/spliced_view.hpp"

#include <cmath>

namespace dseam::splice {

double predicted_error_mm(const geometry::Matrix6& covariance,
                          const Eigen::Vector3d& p_base) noexcept {
  Eigen::Matrix<double, 3, 6> j;
  j << Eigen::Matrix3d::Identity(), -geometry::skew(p_base);
  return std::sqrt((j * covariance * j.transpose()).trace());
}

double predicted_spread_mm(std::span<const SplicedView> views,
                           const Eigen::Vector3d& p_base) noexcept {
  double squares = 0.0;
  double used = 0.0;
  for (const SplicedView& view : views) {
    if (view.state == ViewState::kUsed) {
      const double sigma = predicted_error_mm(view.covariance, p_base);
      squares += sigma * sigma;
      used += 1.0;
    }
  }
  return used > 0.0 ? std::sqrt(squares / used) : 0.0;
}

}  // namespace dseam::splice
