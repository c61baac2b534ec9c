// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "dseam/rt/weld_session.hpp"
#include "rt/session/welding.hpp"

namespace {

using dseam::rt::Fault;
using dseam::rt::WeldSession;
using dseam::test::kMs;
using dseam::test::VirtualCell;
using dseam::test::weld_to_the_end;
using E = dseam::rt::SessionEvent;
using S = dseam::rt::SessionState;

bool recover(VirtualCell& cell) {
  cell.run_until([&] { return cell.session.state() == S::kSafe; }, 3000 * kMs);
  cell.inputs.operator_enable = false;
  cell.run(100 * kMs);
  return cell.session.order(E::kReset).ok();
}

TEST(WeldSession, a_trajectory_that_the_motion_gate_refuses_is_latched_and_never_sent) {
  VirtualCell cell(10);
  (void)cell.session.order(E::kScan);
  std::vector<dseam::trajectory::SetPoint> points(cell.points().begin(), cell.points().end());
  points[30].pose.p_base.z() = 1e9;

  EXPECT_EQ(cell.session.plan(points.front().pose, points).error(), dseam::Errc::kBadData);
  EXPECT_EQ(cell.session.fault(), Fault::kOutsideWorkspace);
  EXPECT_EQ(cell.session.state(), S::kFault);
  ASSERT_TRUE(recover(cell));
  EXPECT_TRUE(weld_to_the_end(cell));
}

TEST(WeldSession, a_start_far_from_the_torch_is_refused) {
  VirtualCell cell(11);
  (void)cell.session.order(E::kScan);
  dseam::torch::TorchPose elsewhere;
  elsewhere.p_base.x() = 50.0;

  EXPECT_FALSE(cell.session.plan(elsewhere, cell.points()).ok());
  EXPECT_EQ(cell.session.fault(), Fault::kSetPointJump);
}

TEST(WeldSession, orders_out_of_place_are_refused_and_counted) {
  VirtualCell cell(13);

  EXPECT_FALSE(cell.session.order(E::kLoad).ok());
  EXPECT_FALSE(cell.session.order(E::kStart).ok());
  EXPECT_FALSE(cell.session.order(E::kHold).ok());
  EXPECT_FALSE(cell.session.order(E::kReset).ok());
  EXPECT_FALSE(cell.session.order(E::kFault).ok());
  EXPECT_FALSE(cell.session.order(E::kFinished).ok());
  EXPECT_FALSE(cell.session.plan({}, cell.points()).ok());
  EXPECT_EQ(cell.session.health().refused, 7U);
}

TEST(WeldSession, a_trajectory_that_the_robot_cannot_take_ends_safe) {
  VirtualCell cell(20);
  (void)cell.session.order(E::kScan);
  std::vector<dseam::trajectory::SetPoint> points(200, cell.points().front());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    points[i].t_us = 100 * i;  // Faster than the robot reads them.
  }
  ASSERT_TRUE(cell.session.plan(points.front().pose, points).ok());
  (void)cell.session.connect(cell.new_session(), cell.now_ns());
  cell.run(300 * kMs);
  ASSERT_TRUE(cell.bring_to(S::kArmed));

  (void)cell.session.order(E::kLoad);

  EXPECT_EQ(cell.session.fault(), Fault::kLinkLost);
  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kSafe; }, 3000 * kMs));
}

TEST(WeldSession, a_bus_that_cannot_be_purged_and_a_session_of_zero_are_refused) {
  VirtualCell cell(21);
  cell.bus.trouble.purge_fails = true;

  EXPECT_FALSE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  cell.bus.trouble.purge_fails = false;
  EXPECT_FALSE(cell.session.connect(0, cell.now_ns()).ok());
  EXPECT_FALSE(cell.session.plan({}, {}).ok());
}

TEST(WeldSession, configurations_that_cannot_be_are_refused) {
  VirtualCell cell(17);
  dseam::link::Sender sender = dseam::link::Sender::make({}).value();
  const auto refused = [&](auto set) {
    WeldSession::Config config;
    set(config);
    return !WeldSession::make(config, sender, cell.bus).ok();
  };

  EXPECT_TRUE(refused([](auto& c) { c.silence_ns = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.vision_limit_ns = -1; }));
  EXPECT_TRUE(refused([](auto& c) { c.rest_limit_ns = 1; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_overruns = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.overrun_window = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.overrun_window = 65; }));
  EXPECT_TRUE(refused([](auto& c) { c.frames_per_cycle = 0; }));
  EXPECT_TRUE(refused([](auto& c) { c.tracker.standing_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.tracker.settle_ns = -1; }));
  EXPECT_TRUE(refused([](auto& c) { c.arc.max_tracking_mm = -1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.motion.max_speed_mm_s = 0.0; }));
}

}  // namespace
