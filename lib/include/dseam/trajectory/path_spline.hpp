// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "dseam/torch/torch_path.hpp"

namespace dseam::trajectory {

/// First to third derivative of the path by its parameter `s`, as lengths of vectors.
struct PathRates {
  double tangent = 0.0;    ///< |dp/ds|
  double curvature = 0.0;  ///< |d2p/ds2|, 1/mm
  double third = 0.0;      ///< |d3p/ds3|, 1/mm2
  double turn = 0.0;       ///< |w| per mm, rad/mm
  double turn_rate = 0.0;  ///< |dw/ds|, rad/mm2
};

/// The path between two neighbouring points: a uniform cubic B-spline over four of them, so that
/// position and orientation have continuous second derivatives.
///
/// The curve keeps within h^2 * curvature / 6 of points that lie h apart, and passes through the
/// two ends of a stretch.
///
/// Source:  de Boor 1978; Kim, Kim and Shin 1995 for the orientation; Sommer et al. 2020 for its
///          derivatives.
class PathSpan {
 public:
  /// The span from point `i` to `i + 1` of the stretch [begin, end] of `path`.
  PathSpan(torch::PathView path, std::size_t begin, std::size_t end, std::size_t i) noexcept;
  PathSpan() = default;

  /// The parameter in [0, 1] at which the path's length is `s_mm`.
  [[nodiscard]] double parameter_at(double s_mm) const noexcept;
  [[nodiscard]] double s_at(double u) const noexcept;
  [[nodiscard]] torch::TorchPose pose_at(double u) const noexcept;
  [[nodiscard]] PathRates rates_at(double u) const noexcept;

 private:
  std::array<Eigen::Vector3d, 4> p_{};
  std::array<double, 4> s_{};
  Eigen::Quaterniond q_first_ = Eigen::Quaterniond::Identity();
  std::array<Eigen::Vector3d, 3> turn_{};  ///< Rotation vectors from one point to the next.
};

}  // namespace dseam::trajectory
