// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::geometry {

/// The same point in two frames.
struct PointPair {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double weight = 1.0;  ///< One over the variance of the difference, 1/mm^2.
};

enum class RigidFitState : std::uint8_t {
  kDetermined,
  kTooFew,     ///< Fewer than three pairs, or nothing finite.
  kCollinear,  ///< The points lie on a line: a spin about it is free.
  kMirrored,   ///< Only a reflection brings them together.
};

/// `T_a_b` that minimises the sum of weight |a - T b|^2, the paper's equation 1.
///
/// Shape:   `covariance` is of `perturbed(T_a_b, .)`, about the origin of a.
struct RigidFit {
  RigidFitState state = RigidFitState::kTooFew;
  RigidTransform T_a_b;
  Matrix6 covariance = Matrix6::Zero();
  double rms_mm = 0.0;
};

/// Source:  Arun, Huang and Blostein, "Least-Squares Fitting of Two 3-D Point Sets", 1987.
[[nodiscard]] RigidFit fit_rigid(std::span<const PointPair> pairs) noexcept;

}  // namespace dseam::geometry
