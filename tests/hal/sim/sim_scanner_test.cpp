// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/sim_scanner.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "dseam/hal/fake/manual_clock.hpp"

namespace dseam::hal::sim {
namespace {

using namespace std::chrono_literals;

CellConfig small_cell() {
  CellConfig config;
  config.scanner.width = 160;
  config.scanner.height = 120;
  return config;
}

TEST(SimScanner, gives_each_view_once_and_then_says_that_it_is_at_its_end) {
  const Cell cell = Cell::make(small_cell()).value();
  fake::ManualClock clock(1'000'000'000);
  const auto scanner = std::move(SimScanner::make(cell, {}, clock).value());
  DepthCamera& camera = *scanner;
  Rendering expected;
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());
  for (std::size_t i = 0; i < cell.views().size(); ++i) {
    const auto lease = camera.next(1s);

    ASSERT_TRUE(lease.ok());
    cell.scan(i, expected);
    const DepthFrame& frame = lease.value().frame();
    EXPECT_EQ(std::memcmp(frame.depth.data(), expected.depth.data(), frame.depth.size()), 0);
    EXPECT_EQ(std::memcmp(frame.gray.data(), expected.gray.data(), frame.gray.size()), 0);
  }
  EXPECT_EQ(camera.next(1s).error(), Errc::kNotFound);
}

TEST(SimScanner, the_robot_reports_where_it_stood_at_the_exposure) {
  const Cell cell = Cell::make(small_cell()).value();
  fake::ManualClock clock(1'000'000'000);
  const auto scanner = std::move(SimScanner::make(cell, {}, clock).value());
  DepthCamera& camera = *scanner;
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());
  for (const CellView& view : cell.views()) {
    const auto lease = camera.next(1s);
    ASSERT_TRUE(lease.ok());

    const auto pose = scanner->robot_state().pose_at(lease.value().frame().captured_ns);

    ASSERT_TRUE(pose.ok());
    EXPECT_EQ(pose.value().of, PoseOf::kCamera);
    EXPECT_LT(
        geometry::difference(pose.value().T_base_reported, view.T_base_camera_reported).norm(),
        1e-9);
  }
}

TEST(SimScanner, with_a_hand_eye_transform_the_robot_reports_its_flange) {
  const Cell cell = Cell::make(small_cell()).value();
  fake::ManualClock clock(1'000'000'000);
  const geometry::RigidTransform T_flange_camera{geometry::rotation_exp({0.1, 0.2, 0.3}),
                                                 {40.0, -20.0, 90.0}};
  SimScanner::Options options;
  options.T_flange_camera = T_flange_camera;
  const auto scanner = std::move(SimScanner::make(cell, options, clock).value());
  DepthCamera& camera = *scanner;
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());
  const auto lease = camera.next(1s);

  const auto pose = scanner->robot_state().pose_at(lease.value().frame().captured_ns);

  ASSERT_TRUE(pose.ok());
  EXPECT_EQ(pose.value().of, PoseOf::kFlange);
  EXPECT_LT(geometry::difference(pose.value().T_base_reported * T_flange_camera,
                                 cell.views()[0].T_base_camera_reported)
                .norm(),
            1e-9);
}

TEST(SimScanner, refuses_to_be_made_without_buffers) {
  const Cell cell = Cell::make(small_cell()).value();
  fake::ManualClock clock;
  SimScanner::Options options;
  options.num_buffers = 0;

  EXPECT_EQ(SimScanner::make(cell, options, clock).error(), Errc::kInvalidArgument);
}

}  // namespace
}  // namespace dseam::hal::sim
