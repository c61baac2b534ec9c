// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/calibration/hand_eye.hpp"
#include "support/gaussian.hpp"

namespace dseam::calibration::test {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;

using dseam::test::gaussian;

inline Eigen::Vector3d gaussian3(Pcg32& random) {
  return {gaussian(random), gaussian(random), gaussian(random)};
}

struct Noise {
  double sigma_mm = 0.05;
  double sigma_rad = 0.02 * kRadPerDeg;
};

/// A pose whose position is off by noise, and whose orientation is, about its own origin.
inline geometry::RigidTransform noisy(const geometry::RigidTransform& pose, const Noise& noise,
                                      Pcg32& random) {
  return {geometry::rotation_exp(noise.sigma_rad * gaussian3(random)) * pose.rotation,
          pose.translation_mm + noise.sigma_mm * gaussian3(random)};
}

inline geometry::RigidTransform true_hand_eye() {
  return {geometry::rotation_exp({0.05, -0.1, 1.5}), {-70.0, 30.0, 90.0}};
}

/// Stations with a lever of 640 mm from the flange to the target, turned about
/// axes spread over all directions, as a careful operator would choose them.
/// `min_turn_deg` to 45 degrees from their mean.
inline std::vector<PosePair> true_stations(std::size_t count, Pcg32& random,
                                           double min_turn_deg = 25.0) {
  const geometry::RigidTransform T_base_target{Eigen::Matrix3d::Identity(), {600.0, 100.0, 50.0}};
  const Eigen::Matrix3d looking_down = geometry::rotation_exp({std::numbers::pi, 0.0, 0.0});
  constexpr double kGoldenAngleRad = 2.399963229728653;
  const double turn = 2.0 * std::numbers::pi * random.uniform();
  std::vector<PosePair> stations;
  for (std::size_t i = 0; i < count; ++i) {
    const double step = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double height = 1.0 - 2.0 * step;
    const double azimuth = turn + kGoldenAngleRad * static_cast<double>(i);
    const double radius = std::sqrt(1.0 - height * height);
    const Eigen::Vector3d axis(radius * std::cos(azimuth), radius * std::sin(azimuth), height);
    const double angle_rad = (min_turn_deg + (45.0 - min_turn_deg) * random.uniform()) * kRadPerDeg;
    const Eigen::Vector3d p_flange =
        Eigen::Vector3d(0.0, 0.0, 560.0 + 160.0 * random.uniform()) + 20.0 * gaussian3(random);
    const geometry::RigidTransform T_camera_target{
        geometry::rotation_exp(angle_rad * axis) * looking_down,
        true_hand_eye().inverse() * p_flange};
    stations.push_back(
        {T_base_target * T_camera_target.inverse() * true_hand_eye().inverse(), T_camera_target});
  }
  return stations;
}

inline std::vector<PosePair> noisy_stations(const std::vector<PosePair>& truth, const Noise& noise,
                                            Pcg32& random) {
  std::vector<PosePair> stations = truth;
  for (PosePair& s : stations) {
    s.T_base_flange = noisy(s.T_base_flange, noise, random);
    s.T_camera_target = noisy(s.T_camera_target, noise, random);
  }
  return stations;
}

}  // namespace dseam::calibration::test
