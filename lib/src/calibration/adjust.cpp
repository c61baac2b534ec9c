// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "calibration/stations.hpp"
#include "dseam/geometry/symmetric_matrix.hpp"

namespace dseam::calibration {
namespace {

using geometry::Matrix6;
using geometry::RigidTransform;
using geometry::Vector6;

/// How the misclosure moves with a left perturbation of X. With W, which turns about the target
/// itself, it moves by minus the identity.
Matrix6 jacobian(const PosePair& station, const Loop& loop) noexcept {
  const Eigen::Matrix3d& R_base_flange = station.T_base_flange.rotation;
  const Eigen::Vector3d p_flange = loop.T_flange_camera * station.T_camera_target.translation_mm;
  Matrix6 j = Matrix6::Zero();
  j.topLeftCorner<3, 3>() = R_base_flange;
  j.topRightCorner<3, 3>() = -R_base_flange * geometry::skew(p_flange);
  j.bottomRightCorner<3, 3>() = R_base_flange;
  return j;
}

/// The noise of both poses in the misclosure: the flange's turn acts through the whole lever.
Matrix6 misclosure_covariance(const PosePair& station, const Loop& loop,
                              const HandEyeConfig& config) noexcept {
  const Eigen::Vector3d lever = station.T_base_flange.rotation *
                                (loop.T_flange_camera * station.T_camera_target.translation_mm);
  const Eigen::Matrix3d arm = -geometry::skew(lever);
  const double flange_turn = config.flange_sigma_rad * config.flange_sigma_rad;
  const double target_turn = config.target_sigma_rad * config.target_sigma_rad;
  const double shift = config.flange_sigma_mm * config.flange_sigma_mm +
                       config.target_sigma_mm * config.target_sigma_mm;
  Matrix6 c;
  c.topLeftCorner<3, 3>() =
      flange_turn * arm * arm.transpose() + shift * Eigen::Matrix3d::Identity();
  c.topRightCorner<3, 3>() = flange_turn * arm;
  c.bottomLeftCorner<3, 3>() = flange_turn * arm.transpose();
  c.bottomRightCorner<3, 3>() = (flange_turn + target_turn) * Eigen::Matrix3d::Identity();
  return c;
}

/// Weighted sums over the stations; with two unknown transforms they are four blocks of 6x6.
struct NormalEquations {
  Matrix6 xx = Matrix6::Zero();
  Matrix6 xw = Matrix6::Zero();
  Matrix6 ww = Matrix6::Zero();
  Vector6 x = Vector6::Zero();
  Vector6 w = Vector6::Zero();
  double chi_square = 0.0;

  void add(const PosePair& station, const Loop& loop, const HandEyeConfig& config) noexcept {
    const Matrix6 covariance = misclosure_covariance(station, loop, config);
    const Matrix6 weight = geometry::inverse_of_symmetric<6>(covariance);
    const Vector6 r = misclosure(station, loop);
    const Matrix6 j = jacobian(station, loop);
    const Matrix6 weighted = weight * j;
    xx += j.transpose() * weighted;
    xw -= weighted.transpose();
    ww += weight;
    x -= weighted.transpose() * r;
    w += weight * r;
    chi_square += r.dot(weight * r);
  }
  /// The information about X when W is unknown: the Schur complement.
  [[nodiscard]] Matrix6 information() const noexcept {
    return xx - xw * geometry::solve_columns(Eigen::LLT<Matrix6>(ww), Matrix6(xw.transpose()));
  }
};

[[gnu::noinline]] NormalEquations normal_equations(const Stations& stations, const Loop& loop,
                                                   const HandEyeConfig& config) noexcept {
  NormalEquations sum;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    sum.add(stations[i], loop, config);
  }
  return sum;
}

/// One Gauss-Newton step; the length of the step, or infinity where there is none.
/// Not inlined, like the sums: their 6x6 blocks together would fill the stack frame.
[[gnu::noinline]] double improve(const NormalEquations& equations, Loop& loop) noexcept {
  const Eigen::LLT<Matrix6> ww(equations.ww);
  const Vector6 x =
      equations.information().ldlt().solve(equations.x - equations.xw * ww.solve(equations.w));
  const Vector6 w = ww.solve(equations.w - equations.xw.transpose() * x);
  if (!x.allFinite() || !w.allFinite()) {
    return std::numeric_limits<double>::infinity();
  }
  loop.T_flange_camera = geometry::perturbed(loop.T_flange_camera, x);
  loop.T_base_target.rotation = geometry::rotation_exp(w.tail<3>()) * loop.T_base_target.rotation;
  loop.T_base_target.translation_mm += w.head<3>();
  return std::sqrt(x.squaredNorm() + w.squaredNorm());
}

}  // namespace

Vector6 misclosure(const PosePair& station, const Loop& loop) noexcept {
  const RigidTransform T_base_target =
      station.T_base_flange * loop.T_flange_camera * station.T_camera_target;
  Vector6 r;
  r.head<3>() = T_base_target.translation_mm - loop.T_base_target.translation_mm;
  r.tail<3>() =
      geometry::rotation_log(T_base_target.rotation * loop.T_base_target.rotation.transpose());
  return r;
}

Adjusted adjust(const Stations& stations, const Loop& start, const HandEyeConfig& config,
                int max_iterations) noexcept {
  constexpr double kConvergedStep = 1e-10;
  Adjusted result{.loop = start, .covariance = Matrix6::Zero(), .chi_square = 0.0};
  double step = 1.0;
  for (int i = 0; i < max_iterations && step > kConvergedStep && std::isfinite(step); ++i) {
    step = improve(normal_equations(stations, result.loop, config), result.loop);
  }
  const NormalEquations equations = normal_equations(stations, result.loop, config);
  result.covariance = geometry::inverse_of_symmetric<6>(equations.information());
  result.chi_square = equations.chi_square;
  return result;
}

}  // namespace dseam::calibration
