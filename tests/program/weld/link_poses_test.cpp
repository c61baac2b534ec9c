// SPDX-License-Identifier: Apache-2.0
#include "scan/pose/link_poses.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/link/receiver.hpp"
#include "failure.hpp"

namespace dseam::program {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A robot that is driven by hand: it turns and moves evenly, and its clock is not ours.
class MovedRobot {
 public:
  explicit MovedRobot(hal::CanBus& bus)
      : memory_(link::Receiver::bytes(16)),
        arena_(memory_),
        receiver_(link::Receiver::make({}, 16, arena_).value()),
        port_(bus) {}

  static torch::TorchPose pose_at(std::int64_t now_ns) {
    const double s = 1e-9 * static_cast<double>(now_ns);
    torch::TorchPose pose;
    pose.p_base = {100.0 * s, 5.0, 300.0};
    pose.q_base_torch = Eigen::AngleAxisd(0.2 * s, Eigen::Vector3d::UnitZ());
    return pose;
  }
  void step(std::int64_t now_ns) {
    receiver_.report_pose(pose_at(now_ns), 100.0);
    port_.turn(receiver_, now_ns - kClockBehindNs);
  }

 private:
  static constexpr std::int64_t kClockBehindNs = 700 * kMs;

  std::vector<std::byte> memory_;
  Arena arena_;
  link::Receiver receiver_;
  hal::LinkPort port_;
};

TEST(LinkPoses, a_moving_robot_is_known_at_the_moment_of_exposure) {
  hal::fake::ManualClock clock(1000 * kMs);
  hal::sim::SimBus bus({}, clock);
  hal::CanBus& host_end = bus.connect();
  MovedRobot robot(bus.connect());
  LinkPoses poses(host_end, {}, 7, 1000 * kMs);
  for (std::int64_t now_ns = 1000 * kMs; now_ns < 2000 * kMs; now_ns += kMs) {
    clock.advance(kMs);
    robot.step(now_ns + kMs);
    poses.step(now_ns + kMs);
  }

  ASSERT_TRUE(poses.reporting());
  for (const std::int64_t exposed_ns : {1500 * kMs, 1703 * kMs, 1937 * kMs}) {
    const auto pose = poses.state().pose_at(exposed_ns);
    ASSERT_TRUE(pose.ok());
    EXPECT_EQ(pose.value().of, hal::PoseOf::kFlange);
    const torch::TorchPose truth = MovedRobot::pose_at(exposed_ns);
    const geometry::RigidTransform& T = pose.value().T_base_reported;
    // The way over the bus is a millisecond or two: at 100 mm/s and 0.2 rad/s that much.
    EXPECT_LT((T.translation_mm - truth.p_base).norm(), 0.25);
    EXPECT_LT(Eigen::Quaterniond(T.rotation).angularDistance(truth.q_base_torch), 1e-3);
  }
  EXPECT_FALSE(poses.state().pose_at(2500 * kMs).ok());  // Never extrapolated.
}

TEST(LinkPoses, nobody_on_the_bus_is_not_a_pose) {
  hal::fake::ManualClock clock(1000 * kMs);
  hal::sim::SimBus bus({}, clock);
  LinkPoses poses(bus.connect(), {}, 7, 1000 * kMs);

  for (std::int64_t now_ns = 1000 * kMs; now_ns < 1500 * kMs; now_ns += kMs) {
    clock.advance(kMs);
    poses.step(now_ns);
  }

  EXPECT_FALSE(poses.reporting());
  EXPECT_FALSE(poses.state().pose_at(1400 * kMs).ok());
}

TEST(LinkPoses, a_live_scan_names_the_interface_that_is_not_there) {
  EXPECT_THROW(ListeningToRobot("nosuch0", {}), Failure);
}

}  // namespace
}  // namespace dseam::program
