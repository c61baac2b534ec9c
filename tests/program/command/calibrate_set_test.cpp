// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "files/hand_eye_file.hpp"
#include "program/support/run_program.hpp"
#include "program/support/sim_scan_set.hpp"

namespace dseam::program {
namespace {

using geometry::RigidTransform;
using test::Outcome;

constexpr double kDegree = std::numbers::pi / 180.0;
const RigidTransform kHandEye{geometry::rotation_exp({0.05, -0.08, 1.2}), {62.0, -35.0, 118.0}};

/// Stations round a workpiece with markers, so many degrees from upright.
hal::sim::CellConfig stations(double tilt_deg, std::uint32_t count = 12) {
  hal::sim::CellConfig config = test::half_size_cell();
  config.views.count = count;
  config.views.tilt_rad = tilt_deg * kDegree;
  config.views.pose_error_mm = 0.05;
  config.views.pose_error_rad = 0.02 * kDegree;
  return config;
}

using Cells = std::vector<hal::sim::CellConfig>;

void on_the_flange(std::uint32_t, hal::replay::ScanView& view) {
  view.camera.T_base_flange = *view.camera.T_base_camera * kHandEye.inverse();
  view.camera.T_base_camera.reset();
}

class CalibrateSetTest : public ::testing::Test {
 protected:
  Outcome calibrate(const Cells& cells, const test::EditView& edit = on_the_flange) {
    test::write_scan_set(cells, scratch_.path("set"), edit);
    return test::run_program({"calibrate", scratch_.path("set"), "--out", scratch_.path("out")});
  }
  void expect_refused(const Outcome& outcome, const std::string& fault) {
    EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
    EXPECT_NE(outcome.text.find(fault), std::string::npos) << outcome.text;
    EXPECT_TRUE(scratch_.names_in("out").empty());
  }

  test::ScratchFolder scratch_;
};

TEST_F(CalibrateSetTest, twelve_varied_stations_give_the_mounting_within_its_stated_error) {
  constexpr double kChiSquared999Of6 = 22.46;

  const Outcome outcome = calibrate({stations(30.0), stations(45.0), stations(60.0)});

  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const nlohmann::json file =
      nlohmann::json::parse(std::ifstream(scratch_.path("out/hand_eye.json")));
  const auto values = file.at("covariance").get<std::vector<double>>();
  ASSERT_EQ(values.size(), 36U);
  const geometry::Matrix6 covariance = Eigen::Map<const geometry::Matrix6>(values.data());
  const auto found = read_hand_eye(scratch_.path("out/hand_eye.json")).T_flange_camera;
  const geometry::Vector6 error = geometry::difference(found, kHandEye);
  EXPECT_LT(error.dot(covariance.ldlt().solve(error)), kChiSquared999Of6) << outcome.text;
  EXPECT_LT((found.translation_mm - kHandEye.translation_mm).norm(), 0.5);
  EXPECT_LT(error.tail<3>().norm(), 0.06 * kDegree);
}

TEST_F(CalibrateSetTest, stations_that_turn_about_one_axis_are_refused) {
  expect_refused(calibrate({stations(45.0)}), "turned about one axis only");
}

TEST_F(CalibrateSetTest, two_stations_are_refused) {
  expect_refused(calibrate({stations(30.0, 2), stations(60.0, 2)}), "too few poses");
}

TEST_F(CalibrateSetTest, a_set_without_flange_poses_is_refused) {
  const auto as_it_is = [](std::uint32_t, hal::replay::ScanView&) {};

  expect_refused(calibrate({stations(45.0, 3)}, as_it_is), "view 0 has no T_base_flange");
}

TEST_F(CalibrateSetTest, a_workpiece_without_markers_is_refused) {
  hal::sim::CellConfig bare = stations(45.0, 4);
  bare.markers.count = 0;

  expect_refused(calibrate({bare}), "too few poses");
}

}  // namespace
}  // namespace dseam::program
