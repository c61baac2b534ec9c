// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/mean_sight.hpp"

#include <Eigen/Geometry>

namespace dseam::seam {

MeanSight mean_sight(std::span<const Eigen::Vector3d> viewpoints, const SeamPoint& point) noexcept {
  constexpr double kLeastCosine = 0.05;
  const Eigen::Vector3d lateral = point.tangent.cross(point.n_shell);
  const double outwards = lateral.dot(point.n_nozzle) < 0.0 ? -1.0 : 1.0;
  MeanSight sum{0.0, 0.0};
  double weight = 0.0;
  for (const Eigen::Vector3d& viewpoint : viewpoints) {
    const Eigen::Vector3d sight = (viewpoint - point.p_base).normalized();
    const double on_shell = sight.dot(point.n_shell);
    const double on_nozzle = sight.dot(point.n_nozzle);
    if (on_shell > kLeastCosine && on_nozzle > kLeastCosine) {
      sum.lateral += on_nozzle * outwards * sight.dot(lateral);
      sum.normal += on_nozzle * on_shell;
      weight += on_nozzle;
    }
  }
  return weight > 0.0 ? MeanSight{sum.lateral / weight, sum.normal / weight} : MeanSight{};
}

}  // namespace dseam::seam
