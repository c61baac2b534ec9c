// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "station_builder.hpp"

namespace dseam::calibration {
namespace {

using geometry::RigidTransform;
using geometry::Vector6;

/// The position and orientation of every pose is measured once; this is what the Fisher
/// information of all those measurements leaves for T_flange_camera. Differences instead of the
/// solver's own derivatives, and every true pose a nuisance parameter, so that nothing is shared.
class CramerRao {
 public:
  CramerRao(const std::vector<PosePair>& truth, const test::Noise& noise)
      : size_(12 + 6 * static_cast<Eigen::Index>(truth.size())) {
    information_ = Eigen::MatrixXd::Zero(size_, size_);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      add(truth[i], noise, static_cast<Eigen::Index>(i));
    }
  }
  /// Of the position (mm) and orientation (rad) of the camera on the flange.
  [[nodiscard]] geometry::Matrix6 bound() const {
    return information_.inverse().topLeftCorner<6, 6>();
  }

 private:
  /// Parameters: X, W, and the flange pose; the target pose follows: B = (A X)^-1 W.
  void add(const PosePair& s, const test::Noise& noise, Eigen::Index i) {
    const RigidTransform x = test::true_hand_eye();
    const RigidTransform w = s.T_base_flange * x * s.T_camera_target;
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(12, size_);
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const Vector6 d = kStep * Vector6::Unit(k);
      j.col(k) = change(s.T_base_flange, shifted(x, d), w, s) / kStep;
      j.col(6 + k) = change(s.T_base_flange, x, shifted(w, d), s) / kStep;
      j.col(12 + 6 * i + k) = change(shifted(s.T_base_flange, d), x, w, s) / kStep;
    }
    Eigen::VectorXd weight(12);
    for (int k = 0; k < 12; ++k) {
      const double sigma = k % 6 < 3 ? noise.sigma_mm : noise.sigma_rad;
      weight[k] = 1.0 / (sigma * sigma);
    }
    information_ += j.transpose() * weight.asDiagonal() * j;
  }
  static RigidTransform shifted(const RigidTransform& t, const Vector6& d) {
    return {geometry::rotation_exp(d.tail<3>()) * t.rotation, t.translation_mm + d.head<3>()};
  }
  static Vector6 apart(const RigidTransform& a, const RigidTransform& b) {
    Vector6 d;
    d.head<3>() = a.translation_mm - b.translation_mm;
    d.tail<3>() = geometry::rotation_log(a.rotation * b.rotation.transpose());
    return d;
  }
  static Eigen::Matrix<double, 12, 1> change(const RigidTransform& flange, const RigidTransform& x,
                                             const RigidTransform& w, const PosePair& s) {
    Eigen::Matrix<double, 12, 1> d;
    d.head<6>() = apart(flange, s.T_base_flange);
    d.tail<6>() = apart((flange * x).inverse() * w, s.T_camera_target);
    return d;
  }

  Eigen::Index size_;
  Eigen::MatrixXd information_;
};

struct Statistics {
  double shift_over_bound = 0.0;
  double turn_over_bound = 0.0;
  double shift_95_mm = 0.0;
  double turn_95_deg = 0.0;
  double inside = 0.0;  ///< Share of normalised errors under the 95 % quantile.
};

Statistics run_trials(double min_turn_deg) {
  constexpr int kTrials = 400;
  constexpr double kChiSquare95Of6 = 12.592;
  Pcg32 random(2024);
  double shift = 0.0, turn = 0.0, shift_bound = 0.0, turn_bound = 0.0, inside = 0.0;
  std::vector<double> shifts, turns;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto truth = test::true_stations(12, random, min_turn_deg);
    const auto stations = test::noisy_stations(truth, {}, random);
    const HandEye result = calibrate_hand_eye(stations, {}).value();
    const Vector6 error = geometry::difference(result.T_flange_camera, test::true_hand_eye());
    shifts.push_back(
        (result.T_flange_camera.translation_mm - test::true_hand_eye().translation_mm).norm());
    turns.push_back(error.tail<3>().norm());
    shift += shifts.back() * shifts.back();
    turn += turns.back() * turns.back();
    const geometry::Matrix6 bound = CramerRao(truth, {}).bound();
    shift_bound += bound.topLeftCorner<3, 3>().trace();
    turn_bound += bound.bottomRightCorner<3, 3>().trace();
    inside += error.dot(result.covariance.ldlt().solve(error)) < kChiSquare95Of6 ? 1.0 : 0.0;
  }
  std::sort(shifts.begin(), shifts.end());
  std::sort(turns.begin(), turns.end());
  return {std::sqrt(shift / shift_bound), std::sqrt(turn / turn_bound), shifts[kTrials * 95 / 100],
          turns[kTrials * 95 / 100] / test::kRadPerDeg, inside / kTrials};
}

TEST(HandEyeStatistics, errors_stay_near_the_cramer_rao_bound_and_the_covariance_is_honest) {
  const Statistics s = run_trials(25.0);

  std::printf("over bound %.3f (mm) %.3f (rad); 95 %%: %.3f mm %.4f deg; NEES inside %.3f\n",
              s.shift_over_bound, s.turn_over_bound, s.shift_95_mm, s.turn_95_deg, s.inside);
  EXPECT_LT(s.shift_over_bound, 1.15);
  EXPECT_LT(s.turn_over_bound, 1.15);
  EXPECT_LT(s.turn_95_deg, 0.04);
  EXPECT_GE(s.inside, 0.90);
  EXPECT_LE(s.inside, 0.99);
}

TEST(HandEyeStatistics, stations_turned_by_45_degrees_give_three_tenths_of_a_millimetre) {
  const Statistics s = run_trials(45.0);

  EXPECT_LT(s.shift_95_mm, 0.30);
  EXPECT_LT(s.turn_95_deg, 0.04);
}

}  // namespace
}  // namespace dseam::calibration
