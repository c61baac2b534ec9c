// SPDX-License-Identifier: Apache-2.0
// Hand-eye calibration on a robot, a camera and a target that nobody made for it.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "dot_target.hpp"
#include "dseam/calibration/hand_eye.hpp"
#include "lib/markers/photographs.hpp"
#include "support/measured_data.hpp"

namespace dseam::calibration {
namespace {

using geometry::RigidTransform;

using PhotographedHandEye = test::MeasuredData;

/// The camera as its own calibration has it, without its lens distortion.
constexpr depth::Intrinsics kCamera{640, 480, 542.324, 543.515, 320.474, 226.039};
constexpr double kPitchMm = 24.8;  // As measured; the target's own file says 25.4.
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// A pose as the robot reported it: lines of `x: metres` ... `qw: number`.
RigidTransform flange_pose(int index) {
  std::ifstream file(test::photographs_dir() / "poses" / (std::to_string(index) + ".yaml"));
  std::string key;
  double value = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  while (file >> key >> value) {
    if (key.size() == 2) {
      position_m(key[0] - 'x') = value;
    } else if (key == "qw:") {
      q.w() = value;
    } else {
      q.vec()(key[1] - 'x') = value;
    }
  }
  return {q.normalized().toRotationMatrix(), 1000.0 * position_m};
}

std::vector<PosePair> stations() {
  const test::DotTarget target(10, kPitchMm, kCamera);
  std::vector<PosePair> out;
  for (int i = 0; i < test::kNumPhotographs; ++i) {
    const auto pose = target.T_camera_target(test::find_dots(test::load_photograph(i)));
    if (pose) {
      out.push_back({flange_pose(i), *pose});
    }
  }
  return out;
}

HandEye calibrate() {
  HandEyeConfig config;
  config.flange_sigma_mm = 0.5;
  config.flange_sigma_rad = 0.1 * kRadPerDeg;
  config.target_sigma_mm = 2.0;                // A lens of unknown distortion, 0.8 m away.
  config.target_sigma_rad = 1.0 * kRadPerDeg;  // It covers a quarter of the picture's width.
  return calibrate_hand_eye(stations(), config).value();
}

TEST_F(PhotographedHandEye, camera_is_found_where_it_was_mounted) {
  const HandEye result = calibrate();

  EXPECT_EQ(result.verdict, HandEyeVerdict::kGood) << name(result.verdict);
  const Eigen::Vector3d mounted_mm(-73.0, 28.0, 88.0);
  constexpr double kKnownToMm = 10.0;  // Three pixels of the lens's axis are 5 mm of it.
  EXPECT_LT((result.T_flange_camera.translation_mm - mounted_mm).norm(),
            kKnownToMm + 2.0 * result.expected_mm)
      << result.T_flange_camera.translation_mm.transpose();
  const Eigen::Vector3d turn_rad = geometry::rotation_log(result.T_flange_camera.rotation);
  EXPECT_NEAR(std::abs(turn_rad.z()), std::numbers::pi / 2.0, 5.0 * kRadPerDeg);
  EXPECT_LT(turn_rad.head<2>().norm(), 5.0 * kRadPerDeg) << turn_rad.transpose();
}

TEST_F(PhotographedHandEye, camera_is_known_to_millimetres_and_the_target_is_of_its_size) {
  const HandEye result = calibrate();

  EXPECT_LT(result.expected_mm, 8.0);
  EXPECT_NEAR(result.residual_ratio, 1.0, 0.5);
  EXPECT_NEAR(result.scale, 1.0, 3.0 * result.scale_sigma);
}

TEST_F(PhotographedHandEye, nearly_every_photograph_gives_a_pose) {
  EXPECT_GE(stations().size(), 12U);
}

}  // namespace
}  // namespace dseam::calibration
