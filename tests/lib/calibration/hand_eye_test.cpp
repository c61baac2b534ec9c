// SPDX-License-Identifier: Apache-2.0
#include "dseam/calibration/hand_eye.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "station_builder.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::calibration {
namespace {

using geometry::RigidTransform;

std::vector<PosePair> typical(std::size_t count = 12) {
  Pcg32 random(7);
  return test::noisy_stations(test::true_stations(count, random), {}, random);
}

HandEyeVerdict verdict(const std::vector<PosePair>& stations) {
  return calibrate_hand_eye(stations, {}).value().verdict;
}

TEST(HandEye, exact_stations_give_the_exact_transform_without_a_single_allocation) {
  Pcg32 random(1);
  const auto stations = test::true_stations(8, random);
  const dseam::test::AllocationCounter allocations;

  const auto result = calibrate_hand_eye(stations, {});

  EXPECT_EQ(allocations.count(), 0U);
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().verdict, HandEyeVerdict::kGood);
  EXPECT_LT(geometry::difference(result.value().T_flange_camera, test::true_hand_eye()).norm(),
            1e-7);
}

TEST(HandEye, noise_as_stated_gives_residuals_as_stated) {
  const HandEye result = calibrate_hand_eye(typical(), {}).value();

  EXPECT_EQ(result.verdict, HandEyeVerdict::kGood);
  EXPECT_NEAR(result.residual_ratio, 1.0, 0.4);
  EXPECT_GT(result.expected_tool_mm, 0.0);
  EXPECT_LT(result.leave_one_out_mm, 5.0 * result.expected_tool_mm);
}

TEST(HandEye, fewer_than_three_stations_are_too_few) {
  EXPECT_EQ(verdict(typical(2)), HandEyeVerdict::kTooFewPoses);
  EXPECT_EQ(verdict({}), HandEyeVerdict::kTooFewPoses);
}

TEST(HandEye, stations_that_hardly_turn_are_named) {
  std::vector<PosePair> stations;
  for (int i = 0; i < 6; ++i) {
    PosePair s;
    s.T_base_flange = {geometry::rotation_exp({0.001 * i, 0.0, 0.0}), {10.0 * i, 0.0, 0.0}};
    s.T_camera_target = (s.T_base_flange * test::true_hand_eye()).inverse();
    stations.push_back(s);
  }

  EXPECT_EQ(verdict(stations), HandEyeVerdict::kPosesTooSimilar);
}

TEST(HandEye, turns_about_one_axis_alone_are_named) {
  std::vector<PosePair> stations;
  for (int i = 0; i < 6; ++i) {
    PosePair s;
    s.T_base_flange = {geometry::rotation_exp({0.0, 0.0, 0.4 * i}), {10.0 * i, 0.0, 500.0}};
    s.T_camera_target = (s.T_base_flange * test::true_hand_eye()).inverse();
    stations.push_back(s);
  }

  EXPECT_EQ(verdict(stations), HandEyeVerdict::kParallelAxes);
}

TEST(HandEye, inverted_flange_poses_are_named) {
  auto stations = typical();
  for (PosePair& s : stations) {
    s.T_base_flange = s.T_base_flange.inverse();
  }

  EXPECT_EQ(verdict(stations), HandEyeVerdict::kFlangeReversed);
}

TEST(HandEye, inverted_target_poses_are_named) {
  auto stations = typical();
  for (PosePair& s : stations) {
    s.T_camera_target = s.T_camera_target.inverse();
  }

  EXPECT_EQ(verdict(stations), HandEyeVerdict::kTargetReversed);
}

TEST(HandEye, target_poses_in_metres_or_of_a_wrong_pitch_are_a_wrong_scale) {
  for (const double scale : {0.001, 1.024}) {
    auto stations = typical();
    for (PosePair& s : stations) {
      s.T_camera_target.translation_mm *= scale;
    }

    const HandEye result = calibrate_hand_eye(stations, {}).value();

    EXPECT_EQ(result.verdict, HandEyeVerdict::kWrongScale)
        << scale << ' ' << result.residual_ratio << ' ' << result.scale_sigma;
    EXPECT_NEAR(result.scale * scale, 1.0, 0.01);
  }
}

TEST(HandEye, unexplained_residuals_are_large_and_the_worst_station_is_found) {
  auto stations = typical();
  stations[5].T_camera_target.translation_mm += Eigen::Vector3d(20.0, -10.0, 5.0);

  const HandEye result = calibrate_hand_eye(stations, {}).value();

  EXPECT_EQ(result.verdict, HandEyeVerdict::kLargeResidual);
  EXPECT_EQ(result.worst_station, 5U);
}

TEST(HandEye, values_that_are_not_finite_and_bad_sigmas_are_invalid) {
  auto stations = typical();
  stations[3].T_base_flange.translation_mm.x() = std::numeric_limits<double>::quiet_NaN();

  EXPECT_EQ(calibrate_hand_eye(stations, {}).error(), Errc::kInvalidArgument);
  EXPECT_EQ(calibrate_hand_eye(typical(), {.flange_sigma_mm = 0.0}).error(),
            Errc::kInvalidArgument);
  EXPECT_EQ(calibrate_hand_eye(std::vector<PosePair>(kMaxPosePairs + 1), {}).error(),
            Errc::kInvalidArgument);
}

}  // namespace
}  // namespace dseam::calibration
