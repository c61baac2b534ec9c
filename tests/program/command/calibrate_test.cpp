// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "dseam/geometry/rigid_transform.hpp"
#include "failure.hpp"
#include "files/hand_eye_file.hpp"
#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using geometry::RigidTransform;
using test::Outcome;
using test::run_program;

const RigidTransform kHandEye{geometry::rotation_exp({0.1, 0.2, 1.5}), {50.0, 20.0, 80.0}};

/// Twelve stations without noise that see one target with the hand-eye transform above.
nlohmann::json true_pairs() {
  const RigidTransform T_base_target{geometry::rotation_exp({0.0, 0.0, 0.3}), {700.0, 0.0, 200.0}};
  nlohmann::json pairs = nlohmann::json::array();
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d turn(0.6 * std::sin(1.3 * i), 0.6 * std::cos(2.1 * i), 0.2 * i);
    const RigidTransform T_base_flange{geometry::rotation_exp(turn),
                                       {700.0 + 9.0 * i, 5.0 * i, 800}};
    const RigidTransform T_camera_target = (T_base_flange * kHandEye).inverse() * T_base_target;
    pairs.push_back({{"T_base_flange", geometry::to_row_major(T_base_flange)},
                     {"T_camera_target", geometry::to_row_major(T_camera_target)}});
  }
  return pairs;
}

class CalibrateTest : public ::testing::Test {
 protected:
  Outcome calibrate(const std::string& content) {
    const std::string file = scratch_.write("pairs.json", content);
    return run_program({"calibrate", file, "--out", scratch_.path("out")});
  }
  void expect_refused(const std::string& content, const std::string& fault) {
    const Outcome outcome = calibrate(content);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_NE(outcome.text.find(fault), std::string::npos) << outcome.text;
    EXPECT_TRUE(scratch_.names_in("out").empty());
  }

  test::ScratchFolder scratch_;
};

TEST_F(CalibrateTest, the_transform_it_writes_is_read_back) {
  const Outcome outcome = calibrate(true_pairs().dump());

  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const HandEyeFile read = read_hand_eye(scratch_.path("out/hand_eye.json"));
  EXPECT_LT(geometry::difference(read.T_flange_camera, kHandEye).norm(), 1e-6);
}

TEST_F(CalibrateTest, a_file_with_one_digit_changed_is_refused) {
  ASSERT_EQ(calibrate(true_pairs().dump()).exit_code, 0);
  std::ifstream in(scratch_.path("out/hand_eye.json"));
  nlohmann::json content = nlohmann::json::parse(in);
  content["T_flange_camera"][3] = 51.0;
  const std::string damaged = scratch_.write("damaged.json", content.dump());

  EXPECT_THROW((void)read_hand_eye(damaged), Failure);
}

TEST_F(CalibrateTest, bad_pairs_are_named) {
  expect_refused("", "empty");
  expect_refused("{\"a\": [", "truncated");
  expect_refused("7", "neither a list nor an object");
  expect_refused("[]", "too few poses");
  expect_refused("[{\"T_base_flange\": [1, 2, 3]}]", "pair 0: T_base_flange is not 16 numbers");
  expect_refused("[{}]", "pair 0: no T_base_flange");
}

TEST_F(CalibrateTest, a_matrix_that_is_not_rigid_is_named) {
  nlohmann::json pairs = true_pairs();
  pairs[3]["T_camera_target"][0] = 1.3;

  expect_refused(pairs.dump(), "pair 3: T_camera_target is not a rigid transform");
}

TEST_F(CalibrateTest, targets_in_metres_are_named) {
  nlohmann::json pairs = true_pairs();
  for (nlohmann::json& pair : pairs) {
    for (const std::size_t i : {3U, 7U, 11U}) {
      pair["T_camera_target"][i] = pair["T_camera_target"][i].get<double>() / 1000.0;
    }
  }

  expect_refused(pairs.dump(), "another unit");
}

TEST_F(CalibrateTest, a_whole_calibration_in_metres_is_named) {
  nlohmann::json pairs = true_pairs();
  for (nlohmann::json& pair : pairs) {
    for (const char* pose : {"T_base_flange", "T_camera_target"}) {
      for (const std::size_t i : {3U, 7U, 11U}) {
        pair[pose][i] = pair[pose][i].get<double>() / 1000.0;
      }
    }
  }

  expect_refused(pairs.dump(), "in metres?");
}

}  // namespace
}  // namespace dseam::program
