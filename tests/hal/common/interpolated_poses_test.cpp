// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/pose/interpolated_poses.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>
#include <thread>

#include "support/allocation_counter.hpp"

namespace dseam::hal {
namespace {

constexpr std::int64_t kMs = 1'000'000;

class InterpolatedPosesTest : public ::testing::Test {
 protected:
  static StampedPose pose(std::int64_t stamp_ns, double x_mm, double turn_rad) {
    return {stamp_ns,
            PoseOf::kFlange,
            {geometry::rotation_exp({0, 0, turn_rad}), Eigen::Vector3d(x_mm, 0, 500)}};
  }

  std::array<InterpolatedPoses::Slot, 4> slots_;
  InterpolatedPoses poses_{slots_};
};

TEST_F(InterpolatedPosesTest, between_two_reports_it_moves_straight_and_turns_evenly) {
  ASSERT_TRUE(poses_.push(pose(10 * kMs, 100, 0.0)).ok());
  ASSERT_TRUE(poses_.push(pose(20 * kMs, 200, std::numbers::pi / 2)).ok());

  const auto at = poses_.pose_at(13 * kMs);

  ASSERT_TRUE(at.ok());
  EXPECT_NEAR(at.value().T_base_reported.translation_mm.x(), 130.0, 1e-9);
  EXPECT_NEAR(geometry::rotation_log(at.value().T_base_reported.rotation).z(),
              0.3 * std::numbers::pi / 2, 1e-9);
}

TEST_F(InterpolatedPosesTest, at_a_report_it_is_that_report) {
  ASSERT_TRUE(poses_.push(pose(10 * kMs, 100, 0.1)).ok());

  EXPECT_DOUBLE_EQ(poses_.pose_at(10 * kMs).value().T_base_reported.translation_mm.x(), 100.0);
}

TEST_F(InterpolatedPosesTest, it_never_extrapolates_and_bridges_no_long_silence) {
  EXPECT_EQ(poses_.pose_at(0).error(), Errc::kNotFound);
  ASSERT_TRUE(poses_.push(pose(10 * kMs, 100, 0.1)).ok());
  ASSERT_TRUE(poses_.push(pose(120 * kMs, 200, 0.1)).ok());

  EXPECT_EQ(poses_.pose_at(9 * kMs).error(), Errc::kNotFound);
  EXPECT_EQ(poses_.pose_at(121 * kMs).error(), Errc::kNotFound);
  EXPECT_EQ(poses_.pose_at(60 * kMs).error(), Errc::kNotFound);
}

TEST_F(InterpolatedPosesTest, a_full_ring_forgets_the_oldest) {
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(poses_.push(pose(i * 10 * kMs, i, 0.0)).ok());
  }

  EXPECT_EQ(poses_.pose_at(15 * kMs).error(), Errc::kNotFound);
  EXPECT_NEAR(poses_.pose_at(25 * kMs).value().T_base_reported.translation_mm.x(), 2.5, 1e-9);
}

TEST_F(InterpolatedPosesTest, a_report_from_the_past_or_that_is_no_number_is_refused) {
  ASSERT_TRUE(poses_.push(pose(10 * kMs, 100, 0.1)).ok());

  EXPECT_EQ(poses_.push(pose(10 * kMs, 100, 0.1)).error(), Errc::kInvalidArgument);
  EXPECT_EQ(poses_.push(pose(11 * kMs, std::numeric_limits<double>::quiet_NaN(), 0)).error(),
            Errc::kInvalidArgument);
}

TEST_F(InterpolatedPosesTest, flange_and_camera_poses_are_never_mixed) {
  ASSERT_TRUE(poses_.push(pose(10 * kMs, 100, 0.1)).ok());
  StampedPose of_camera = pose(20 * kMs, 100, 0.1);
  of_camera.of = PoseOf::kCamera;
  ASSERT_TRUE(poses_.push(of_camera).ok());

  EXPECT_EQ(poses_.pose_at(15 * kMs).error(), Errc::kNotFound);
}

TEST_F(InterpolatedPosesTest, a_reader_beside_the_writer_never_sees_half_a_report) {
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 1; i < 20'000; ++i) {
      (void)poses_.push(pose(i * kMs, i, 0.0));
    }
    done = true;
  });

  int torn = 0;
  for (std::int64_t stamp = kMs; !done; stamp += kMs / 2) {
    const auto at = poses_.pose_at(stamp % (20'000 * kMs));
    torn += at.ok() && std::abs(at.value().T_base_reported.translation_mm.x() * kMs -
                                static_cast<double>(at.value().stamp_ns)) > 1.0;
  }
  writer.join();

  EXPECT_EQ(torn, 0);
}

TEST_F(InterpolatedPosesTest, pushing_and_asking_allocate_nothing) {
  const test::AllocationCounter allocations;

  (void)poses_.push(pose(10 * kMs, 100, 0.1));
  (void)poses_.push(pose(20 * kMs, 100, 0.1));
  (void)poses_.pose_at(15 * kMs);

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::hal
