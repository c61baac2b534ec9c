// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "calibration/stations.hpp"

namespace dseam::calibration {
namespace {

using geometry::RigidTransform;

/// Between stations i and j the flange moved by `flange` and the camera by `camera`:
/// flange X = X camera.
struct Motion {
  RigidTransform flange;
  RigidTransform camera;
};

Motion motion(const Stations& stations, std::size_t i, std::size_t j) noexcept {
  const PosePair a = stations[i];
  const PosePair b = stations[j];
  return {a.T_base_flange.inverse() * b.T_base_flange,
          a.T_camera_target * b.T_camera_target.inverse()};
}

template <typename Visit>
void each_motion(const Stations& stations, Visit visit) noexcept {
  for (std::size_t i = 0; i < stations.size(); ++i) {
    for (std::size_t j = i + 1; j < stations.size(); ++j) {
      visit(motion(stations, i, j));
    }
  }
}

/// The rotation that takes the camera's rotation vectors to the flange's (Park and Martin).
Eigen::Matrix3d aligned_rotation(const Stations& stations) noexcept {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  each_motion(stations, [&](const Motion& m) {
    correlation += geometry::rotation_log(m.flange.rotation) *
                   geometry::rotation_log(m.camera.rotation).transpose();
  });
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0.0) {
    u.col(2) *= -1.0;
  }
  return u * svd.matrixV().transpose();
}

/// (R_flange - 1) t_x = scale * R_x t_camera - t_flange, over all motions; unknowns (t_x, scale).
struct LinearTranslation {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double right_squared = 0.0;
  std::size_t equations = 0;

  void add(const Motion& m, const Eigen::Matrix3d& R_flange_camera) noexcept {
    Eigen::Matrix<double, 3, 4> rows;
    rows.leftCols<3>() = m.flange.rotation - Eigen::Matrix3d::Identity();
    rows.col(3) = -(R_flange_camera * m.camera.translation_mm);
    const Eigen::Vector3d b = -m.flange.translation_mm;
    normal += rows.transpose() * rows;
    right += rows.transpose() * b;
    right_squared += b.squaredNorm();
    equations += 3;
  }
};

LinearTranslation linear_translation(const Stations& stations,
                                     const Eigen::Matrix3d& R_flange_camera) noexcept {
  LinearTranslation system;
  each_motion(stations, [&](const Motion& m) { system.add(m, R_flange_camera); });
  return system;
}

}  // namespace

TurnSpread turn_spread(const Stations& stations) noexcept {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double pairs = 0.0;
  each_motion(stations, [&](const Motion& m) {
    const Eigen::Vector3d turn = geometry::rotation_log(m.flange.rotation);
    scatter += turn * turn.transpose();
    pairs += 1.0;
  });
  if (pairs == 0.0) {
    return {};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter / pairs,
                                                            Eigen::EigenvaluesOnly);
  return {std::sqrt(std::fmax(0.0, axes.eigenvalues()[2])),
          std::sqrt(std::fmax(0.0, axes.eigenvalues()[1]))};
}

Loop closed_form(const Stations& stations) noexcept {
  Loop loop;
  loop.T_flange_camera.rotation = aligned_rotation(stations);
  const LinearTranslation system = linear_translation(stations, loop.T_flange_camera.rotation);
  const Eigen::Vector3d right = system.right.head<3>() - system.normal.topRightCorner<3, 1>();
  const Eigen::Matrix3d normal = system.normal.topLeftCorner<3, 3>();
  loop.T_flange_camera.translation_mm = normal.ldlt().solve(right);
  const PosePair first = stations[0];
  loop.T_base_target = first.T_base_flange * loop.T_flange_camera * first.T_camera_target;
  return loop;
}

ScaleGuess target_scale(const Stations& stations, const Eigen::Matrix3d& R_flange_camera) noexcept {
  const LinearTranslation system = linear_translation(stations, R_flange_camera);
  const Eigen::LDLT<Eigen::Matrix4d> ldlt(system.normal);
  const Eigen::Vector4d solution = ldlt.solve(system.right);
  const double rest = std::fmax(0.0, system.right_squared - solution.dot(system.right));
  // The motions are not independent: n stations carry only n - 1 of them.
  const double independent = 3.0 * static_cast<double>(stations.size() - 1) - 4.0;
  const Eigen::Vector4d last = ldlt.solve(Eigen::Vector4d::Unit(3));
  const double per_equation = rest / static_cast<double>(system.equations);
  const double inflation = static_cast<double>(system.equations) / std::fmax(1.0, independent);
  return {solution[3], std::sqrt(std::fmax(0.0, per_equation * last[3] * inflation))};
}

}  // namespace dseam::calibration
