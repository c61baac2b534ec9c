// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/rigid_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::geometry {
namespace {

struct Centred {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  double weight = 0.0;
  std::uint32_t count = 0;
};

bool usable(const PointPair& p) noexcept {
  return p.a.allFinite() && p.b.allFinite() && std::isfinite(p.weight) && p.weight > 0.0;
}

Centred centre(std::span<const PointPair> pairs) noexcept {
  Centred c;
  for (const PointPair& p : pairs) {
    if (usable(p)) {
      c.a += p.weight * p.a;
      c.b += p.weight * p.b;
      c.weight += p.weight;
      ++c.count;
    }
  }
  if (c.count == 0) {
    return c;
  }
  c.a /= c.weight;
  c.b /= c.weight;
  for (const PointPair& p : pairs) {
    if (usable(p)) {
      c.cross += p.weight * (p.b - c.b) * (p.a - c.a).transpose();
    }
  }
  return c;
}

void set_errors(std::span<const PointPair> pairs, RigidFit& fit) noexcept {
  Matrix6 h = Matrix6::Zero();
  double squares = 0.0;
  double count = 0.0;
  for (const PointPair& p : pairs) {
    if (!usable(p)) {
      continue;
    }
    Eigen::Matrix<double, 3, 6> j;
    j << Eigen::Matrix3d::Identity(), -skew(fit.T_a_b * p.b);
    h += p.weight * j.transpose() * j;
    squares += (p.a - fit.T_a_b * p.b).squaredNorm();
    count += 1.0;
  }
  fit.covariance = inverse_of_symmetric<6>(h);
  fit.rms_mm = std::sqrt(squares / count);
}

}  // namespace

RigidFit fit_rigid(std::span<const PointPair> pairs) noexcept {
  RigidFit fit;
  const Centred c = centre(pairs);
  if (c.count < 3) {
    return fit;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(c.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues();
  constexpr double kThinnest = 1e-6;  // Spread across a line over that along it, squared.
  if (!(s(1) > kThinnest * s(0))) {
    fit.state = RigidFitState::kCollinear;
    return fit;
  }
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn(2, 2) = (svd.matrixV() * svd.matrixU().transpose()).determinant() > 0.0 ? 1.0 : -1.0;
  fit.T_a_b.rotation = svd.matrixV() * turn * svd.matrixU().transpose();
  fit.T_a_b.translation_mm = c.a - fit.T_a_b.rotation * c.b;
  set_errors(pairs, fit);
  const bool mirrored = turn(2, 2) < 0.0 && s(2) > 1e-3 * s(1);
  fit.state = mirrored ? RigidFitState::kMirrored : RigidFitState::kDetermined;
  return fit;
}

}  // namespace dseam::geometry
