// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "dseam/base/result.hpp"

namespace dseam::geometry {

/// Translation first, then rotation: (x, y, z) in mm, then the rotation vector in rad.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A rotation and a translation. `T_a_b` takes coordinates in frame b to frame a.
///
/// Units:   mm.
/// Source:  R and T of the paper's equation 1.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const noexcept {
    return rotation * p + translation_mm;
  }
  [[nodiscard]] RigidTransform operator*(const RigidTransform& b) const noexcept {
    return {rotation * b.rotation, rotation * b.translation_mm + translation_mm};
  }
  [[nodiscard]] RigidTransform inverse() const noexcept {
    return {rotation.transpose(), -(rotation.transpose() * translation_mm)};
  }
};

/// Reads a row-major 4x4 matrix and insists that it is rigid.
///
/// Errors:  kBadData: not finite, a last row other than 0 0 0 1, columns that are not orthonormal
///          within `tolerance`, or left-handed. The paper's equation 16 is refused (a row's norm is
///          1.0098). What passes is projected onto the nearest rotation.
[[nodiscard]] Result<RigidTransform> rigid_from_row_major(std::span<const double, 16> matrix,
                                                          double tolerance = 1e-4) noexcept;
[[nodiscard]] Result<RigidTransform> rigid_from_parts(const Eigen::Matrix3d& rotation,
                                                      const Eigen::Vector3d& translation_mm,
                                                      double tolerance = 1e-4) noexcept;
[[nodiscard]] std::array<double, 16> to_row_major(const RigidTransform& transform) noexcept;

/// The rotation by `rotation_vector_rad` (axis times angle).
///
/// Source:  Rodrigues' formula; the series near zero.
[[nodiscard]] Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector_rad) noexcept;
/// The rotation vector, its length in [0, pi].
[[nodiscard]] Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) noexcept;

/// `delta` applied on the left: the result is {exp(w) R, exp(w) t + v} for delta = (v, w), so that
/// a covariance of delta is expressed in the outer frame (`a` of `T_a_b`), about its origin.
[[nodiscard]] RigidTransform perturbed(const RigidTransform& transform,
                                       const Vector6& delta) noexcept;
/// The delta with which `perturbed(from, delta)` is `to`.
[[nodiscard]] Vector6 difference(const RigidTransform& to, const RigidTransform& from) noexcept;

/// [v]x, with which a cross product becomes a matrix product.
[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v) noexcept;

}  // namespace dseam::geometry
