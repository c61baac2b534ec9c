// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

/// A scan set of which the robot's poses were taken away.
std::string set_without_poses(const test::ScratchFolder& scratch) {
  const std::string set = scratch.path("set");
  const Outcome outcome = run_program({"record", "--camera", "sim", "--set", "cell.width=324",
                                       "--set", "cell.height=242", "--out", set});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  std::ifstream in(set + "/scene_camera.json");
  auto json = nlohmann::json::parse(in);
  for (auto& view : json) {
    view.erase("cam_R_w2c");
    view.erase("cam_t_w2c");
    view.erase("T_base_flange");
  }
  std::ofstream(set + "/scene_camera.json") << json.dump();
  return set;
}

TEST(BaseFrame, without_any_robot_pose_no_robot_is_driven) {
  const test::ScratchFolder scratch;
  const std::string set = set_without_poses(scratch);

  const Outcome outcome = run_program({"weld", "--camera", "replay:" + set, "--robot", "sim",
                                       "--set", "seam.max_sigma_mm=100", "--set",
                                       "seam.min_coverage=0.1", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  EXPECT_EQ(outcome.text.find("set points sent"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out").count("can.log"), 0U);
}

TEST(RefusedSeam, drives_no_robot) {
  const test::ScratchFolder scratch;

  const Outcome outcome = run_program({"weld", "--camera", "sim", "--robot", "sim", "--set",
                                       "cell.width=324", "--set", "cell.height=242", "--set",
                                       "cell.unseen_share=0.3", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 4) << outcome.text;
  EXPECT_EQ(outcome.text.find("set points sent"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out").count("can.log"), 0U);
  EXPECT_EQ(scratch.names_in("out").count("report.json"), 1U);
}

TEST(BaseFrame, a_hand_eye_calibration_that_no_view_could_use_is_not_ignored) {
  const test::ScratchFolder scratch;
  const std::string set = set_without_poses(scratch);

  const Outcome outcome = run_program({"weld", "--camera", "replay:" + set, "--hand-eye",
                                       scratch.write("hand_eye.json", R"({"checksum": 5})"),
                                       "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find("hand_eye.json: damaged"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace dseam::program
