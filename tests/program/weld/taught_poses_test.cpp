// SPDX-License-Identifier: Apache-2.0
#include "scan/pose/taught_poses.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "failure.hpp"

namespace dseam::program {
namespace {

std::filesystem::path written(const char* name, const std::string& text) {
  const auto file = std::filesystem::path(::testing::TempDir()) / name;
  std::ofstream(file) << text;
  return file;
}

std::string view_at(double x_mm) {
  return R"({"cam_K": [500, 0, 320, 0, 500, 240, 0, 0, 1], "depth_scale": 0.1,
             "cam_R_w2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_w2c": [)" +
         std::to_string(x_mm) + ", 0, 0]}";
}

TEST(TaughtPoses, come_in_the_order_of_the_views_and_end_with_them) {
  const auto file =
      written("taught.json", R"({"0": )" + view_at(10.0) + R"(, "1": )" + view_at(20.0) + "}");
  TaughtPoses poses(file);
  hal::RobotState& robot = poses;

  EXPECT_FALSE(robot.pose_at(1).ok());  // No view was reached yet.
  for (const double x_mm : {10.0, 20.0}) {
    poses.advance();
    const auto pose = robot.pose_at(5);
    ASSERT_TRUE(pose.ok());
    EXPECT_EQ(pose.value().of, hal::PoseOf::kCamera);
    EXPECT_EQ(pose.value().stamp_ns, 5);
    EXPECT_NEAR(pose.value().T_base_reported.translation_mm.x(), -x_mm, 1e-9);
  }
  poses.advance();
  EXPECT_FALSE(robot.pose_at(9).ok());
}

TEST(TaughtPoses, without_a_file_nothing_is_known_and_a_bad_one_is_named) {
  EXPECT_FALSE(TaughtPoses({}).known());
  EXPECT_THROW(TaughtPoses("/nowhere.json"), Failure);
  EXPECT_THROW(TaughtPoses(written("bad.json", "{")), Failure);
}

}  // namespace
}  // namespace dseam::program
