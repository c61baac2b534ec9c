// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/rigid_transform.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace dseam::geometry {
namespace {

// Below this angle the series is exact to the last bit of a double.
constexpr double kSmallAngleRad = 1e-5;

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) noexcept {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

bool is_rotation(const Eigen::Matrix3d& m, double tolerance) noexcept {
  if (!m.allFinite()) {
    return false;
  }
  const Eigen::Matrix3d error = m.transpose() * m - Eigen::Matrix3d::Identity();
  return error.cwiseAbs().maxCoeff() <= tolerance && m.determinant() > 0.0;
}

}  // namespace

Result<RigidTransform> rigid_from_parts(const Eigen::Matrix3d& rotation,
                                        const Eigen::Vector3d& translation_mm,
                                        double tolerance) noexcept {
  if (!translation_mm.allFinite() || !is_rotation(rotation, tolerance)) {
    return Errc::kBadData;
  }
  return RigidTransform{nearest_rotation(rotation), translation_mm};
}

Result<RigidTransform> rigid_from_row_major(std::span<const double, 16> matrix,
                                            double tolerance) noexcept {
  using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Map<const Matrix4> m(matrix.data());
  const Eigen::RowVector4d last_row(0.0, 0.0, 0.0, 1.0);
  if (!m.allFinite() || (m.row(3) - last_row).cwiseAbs().maxCoeff() > tolerance) {
    return Errc::kBadData;
  }
  return rigid_from_parts(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>(), tolerance);
}

std::array<double, 16> to_row_major(const RigidTransform& transform) noexcept {
  using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  std::array<double, 16> out{};
  Eigen::Map<Matrix4> m(out.data());
  m.setIdentity();
  m.topLeftCorner<3, 3>() = transform.rotation;
  m.topRightCorner<3, 1>() = transform.translation_mm;
  return out;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& v) noexcept {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& rotation_vector_rad) noexcept {
  const double angle = rotation_vector_rad.norm();
  const Eigen::Matrix3d k = skew(rotation_vector_rad);
  const double a = angle < kSmallAngleRad ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
  const double b = angle < kSmallAngleRad ? 0.5 - angle * angle / 24.0
                                          : (1.0 - std::cos(angle)) / (angle * angle);
  return Eigen::Matrix3d::Identity() + a * k + b * (k * k);
}

Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) noexcept {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  const double sine = q.vec().norm();
  const double scale = sine < kSmallAngleRad ? 2.0 / q.w() : 2.0 * std::atan2(sine, q.w()) / sine;
  return scale * q.vec();
}

RigidTransform perturbed(const RigidTransform& transform, const Vector6& delta) noexcept {
  const Eigen::Matrix3d turn = rotation_exp(delta.tail<3>());
  return {turn * transform.rotation, turn * transform.translation_mm + delta.head<3>()};
}

Vector6 difference(const RigidTransform& to, const RigidTransform& from) noexcept {
  const Eigen::Matrix3d turn = to.rotation * from.rotation.transpose();
  Vector6 delta;
  delta.head<3>() = to.translation_mm - turn * from.translation_mm;
  delta.tail<3>() = rotation_log(turn);
  return delta;
}

}  // namespace dseam::geometry
