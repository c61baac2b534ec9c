// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/weld_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "faults.hpp"
#include "support/allocation_counter.hpp"
#include "virtual_cell.hpp"

namespace {

using dseam::rt::Fault;
using dseam::rt::WeldSession;
using dseam::test::FaultKind;
using dseam::test::VirtualCell;
using E = dseam::rt::SessionEvent;
using S = dseam::rt::SessionState;

constexpr std::int64_t kMs = 1'000'000;

WeldSession::Config with_vision() {
  WeldSession::Config config;
  config.vision_limit_ns = 200 * kMs;
  config.arc.max_standing_ns = 300 * kMs;
  return config;
}

bool weld_to_the_end(VirtualCell& cell) {
  return cell.bring_to(S::kRunning) &&
         cell.run_until([&] { return cell.session.state() == S::kIdle; }, 6000 * kMs);
}

/// To the middle of the bead.
bool weld_half(VirtualCell& cell) {
  return cell.bring_to(S::kRunning) &&
         cell.run_until([&] { return cell.executed() > cell.path_points() / 2; }, 4000 * kMs) &&
         cell.arc_on();
}

bool recover(VirtualCell& cell) {
  cell.run_until([&] { return cell.session.state() == S::kSafe; }, 3000 * kMs);
  cell.inputs.operator_enable = false;
  cell.run(100 * kMs);
  return cell.session.order(E::kReset).ok();
}

TEST(WeldSession, welds_the_whole_path_and_comes_back_to_idle) {
  VirtualCell cell(1);

  const bool idle = weld_to_the_end(cell);

  EXPECT_TRUE(idle) << name(cell.session.state()) << " " << name(cell.session.fault());
  EXPECT_EQ(cell.executed(), cell.path_points());
  EXPECT_EQ(cell.session.fault(), Fault::kNone);
  EXPECT_GT(cell.arc_on_ns(), 900 * kMs);
  EXPECT_EQ(cell.breach(), "");
}

TEST(WeldSession, each_fault_while_welding_ends_safe_under_its_own_name) {
  std::uint64_t seed = 1;
  for (const FaultKind& kind : dseam::test::fault_kinds()) {
    VirtualCell cell(seed++, with_vision());
    ASSERT_TRUE(weld_half(cell)) << kind.name;

    kind.begin(cell);
    cell.run(kind.lasts_ns);
    const Fault found = cell.session.fault();
    kind.end(cell);
    cell.run(1500 * kMs);

    EXPECT_NE(std::find(kind.expected.begin(), kind.expected.end(), found), kind.expected.end())
        << kind.name << " gave " << name(found);
    EXPECT_EQ(cell.session.state(), found == Fault::kNone ? S::kIdle : S::kSafe) << kind.name;
    EXPECT_FALSE(cell.arc_on()) << kind.name;
    EXPECT_EQ(cell.breach(), "") << kind.name;
  }
}

TEST(WeldSession, after_a_fault_the_arc_stays_off_until_reset_new_session_and_a_new_edge) {
  VirtualCell cell(3, with_vision());
  ASSERT_TRUE(weld_half(cell));
  cell.session.trip(Fault::kOperator);
  ASSERT_TRUE(cell.run_until([&] { return cell.session.state() == S::kSafe; }, 2000 * kMs));
  const auto arc_ns = cell.arc_on_ns();

  EXPECT_FALSE(cell.session.order(E::kStart).ok());
  EXPECT_FALSE(cell.session.order(E::kArm).ok());
  EXPECT_FALSE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  cell.run(500 * kMs);
  EXPECT_TRUE(cell.session.order(E::kReset).ok());
  EXPECT_EQ(cell.session.state(), S::kIdle);
  EXPECT_FALSE(cell.session.order(E::kArm).ok());
  cell.run(500 * kMs);

  EXPECT_EQ(cell.arc_on_ns(), arc_ns);
  EXPECT_TRUE(weld_to_the_end(cell)) << name(cell.session.fault());
  EXPECT_EQ(cell.breach(), "");
}

TEST(WeldSession, arming_needs_both_conditions_and_an_edge) {
  VirtualCell cell(4);
  ASSERT_TRUE(cell.bring_to(S::kPlanned));

  EXPECT_FALSE(cell.session.order(E::kArm).ok());  // No operator.
  cell.inputs.operator_enable = true;
  cell.inputs.real_time = false;
  cell.cycle();
  EXPECT_FALSE(cell.session.order(E::kArm).ok());  // The system is not ready.
  cell.inputs.real_time = true;
  cell.cycle();
  EXPECT_TRUE(cell.session.order(E::kArm).ok());
  EXPECT_FALSE(cell.session.order(E::kArm).ok());  // Twice.
}

TEST(WeldSession, a_level_that_was_there_all_along_arms_only_once) {
  VirtualCell cell(5);
  ASSERT_TRUE(weld_to_the_end(cell));
  (void)cell.session.order(E::kScan);
  (void)cell.session.plan(cell.points().front().pose, cell.points());
  (void)cell.session.connect(cell.new_session(), cell.now_ns());
  cell.run(300 * kMs);

  EXPECT_FALSE(cell.session.order(E::kArm).ok());
  cell.inputs.operator_enable = false;
  cell.cycle();
  cell.inputs.operator_enable = true;
  cell.cycle();
  EXPECT_TRUE(cell.session.order(E::kArm).ok());
}

TEST(WeldSession, a_session_is_good_for_one_arming) {
  VirtualCell cell(6);
  ASSERT_TRUE(cell.bring_to(S::kArmed));
  ASSERT_TRUE(cell.session.order(E::kStop).ok());
  ASSERT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 2000 * kMs));
  (void)cell.session.order(E::kScan);
  (void)cell.session.plan(cell.points().front().pose, cell.points());
  cell.inputs.operator_enable = false;
  cell.cycle();
  cell.inputs.operator_enable = true;
  cell.cycle();

  EXPECT_FALSE(cell.session.may_arm());
}

TEST(WeldSession, without_privileges_it_arms_only_where_that_is_allowed) {
  WeldSession::Config config;
  config.allow_degraded = true;
  VirtualCell cell(7, config);
  cell.inputs.real_time = false;

  EXPECT_TRUE(weld_to_the_end(cell));
}

TEST(WeldSession, losing_the_operators_condition_stops_with_the_arc_off) {
  VirtualCell cell(8);
  ASSERT_TRUE(weld_half(cell));
  cell.inputs.operator_enable = false;

  cell.cycle();

  EXPECT_EQ(cell.session.state(), S::kStopping);
  EXPECT_FALSE(cell.session.health().arc_permitted);
  cell.run(5 * kMs);
  EXPECT_FALSE(cell.arc_on());
  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 2000 * kMs));
}

TEST(WeldSession, after_a_hold_the_rest_of_the_path_is_driven_without_the_arc) {
  VirtualCell cell(9);
  ASSERT_TRUE(weld_half(cell));

  ASSERT_TRUE(cell.session.order(E::kHold).ok());
  cell.run(400 * kMs);
  EXPECT_FALSE(cell.arc_on());
  EXPECT_FALSE(cell.robot().moving());
  ASSERT_TRUE(cell.session.order(E::kStart).ok());
  cell.run(200 * kMs);
  EXPECT_FALSE(cell.arc_on());
  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 4000 * kMs));
  EXPECT_EQ(cell.breach(), "");
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

TEST(WeldSession, three_overruns_of_sixty_four_trip_and_one_does_not) {
  VirtualCell cell(12);
  ASSERT_TRUE(weld_half(cell));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(cell.session.fault(), Fault::kNone);
    cell.stall_ns = 2 * kMs;
    cell.run(4 * kMs);
  }

  EXPECT_EQ(cell.session.fault(), Fault::kOverrun);
  EXPECT_EQ(cell.session.health().overruns, 3U);
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

TEST(WeldSession, stop_during_start_ends_at_rest) {
  VirtualCell cell(14);
  ASSERT_TRUE(cell.bring_to(S::kLoading));
  ASSERT_TRUE(cell.session.order(E::kStart).ok());
  ASSERT_TRUE(cell.session.order(E::kStop).ok());

  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 3000 * kMs));
  EXPECT_FALSE(cell.arc_on());
  EXPECT_EQ(cell.breach(), "");
}

TEST(WeldSession, a_robot_that_is_not_there_ends_in_a_name) {
  VirtualCell cell(15);
  cell.bus.trouble.cut = true;
  EXPECT_TRUE(cell.bring_to(S::kPlanned));
  cell.inputs.operator_enable = true;
  cell.run(2000 * kMs);

  EXPECT_FALSE(cell.session.order(E::kArm).ok());
  EXPECT_EQ(cell.sender().fault(), dseam::link::Fault::kNoPeer);
}

TEST(WeldSession, holding_twice_is_no_fault_and_a_stop_while_it_holds_ends_it) {
  VirtualCell cell(18);
  ASSERT_TRUE(weld_half(cell));

  EXPECT_TRUE(cell.session.order(E::kHold).ok());
  EXPECT_TRUE(cell.session.order(E::kHold).ok());
  EXPECT_EQ(cell.session.state(), S::kHold);
  EXPECT_TRUE(cell.session.order(E::kStop).ok());
  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 2000 * kMs));
}

TEST(WeldSession, a_stop_before_the_robot_has_armed_ends_safe) {
  VirtualCell cell(19);
  ASSERT_TRUE(cell.bring_to(S::kPlanned));
  cell.inputs.operator_enable = true;
  cell.cycle();
  ASSERT_TRUE(cell.session.order(E::kArm).ok());

  EXPECT_TRUE(cell.session.order(E::kStop).ok());
  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kSafe; }, 3000 * kMs));
  EXPECT_FALSE(cell.arc_on());
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

TEST(WeldSession, a_blocked_bus_is_named_when_it_is_the_first_to_show) {
  WeldSession::Config config;
  config.silence_ns = 8 * kMs;
  VirtualCell cell(22, config);
  ASSERT_TRUE(weld_half(cell));
  cell.bus.trouble.blocked = true;

  cell.run(16 * kMs);

  EXPECT_EQ(cell.session.fault(), Fault::kTxBlocked);
}

TEST(WeldSession, a_robot_that_falls_silent_while_armed_leaves_stale_data) {
  VirtualCell cell(23);
  ASSERT_TRUE(cell.bring_to(S::kArmed));
  cell.robot_trouble.silent = true;

  cell.run(100 * kMs);

  EXPECT_EQ(cell.session.fault(), Fault::kDataStale);
}

TEST(WeldSession, a_second_greeting_replaces_the_first) {
  VirtualCell cell(24);

  EXPECT_TRUE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  EXPECT_TRUE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  cell.run(300 * kMs);
  EXPECT_EQ(cell.sender().state(), dseam::link::HostState::kIdle);
}

TEST(PathTracker, without_a_path_it_tells_only_of_the_torch) {
  dseam::rt::PathTracker tracker{{}};
  dseam::rt::ArcInputs in;
  dseam::link::PoseReport pose;
  pose.speed_mm_s = 3.0;

  tracker.look(pose, 0, 1000, in);

  EXPECT_EQ(in.speed_mm_s, 3.0);
  EXPECT_EQ(in.corridor_mm, 0.0);
}

TEST(WeldSession, the_cycle_allocates_nothing) {
  VirtualCell cell(16);
  ASSERT_TRUE(weld_half(cell));
  cell.bus.sent_this_cycle.clear();
  WeldSession::Inputs inputs = cell.inputs;
  inputs.tick.woke_ns = cell.now_ns();
  cell.bus.trouble.blocked = true;
  const dseam::test::AllocationCounter counter;

  for (int i = 0; i < 10; ++i) {
    cell.session.step(inputs);
  }

  EXPECT_EQ(counter.count(), 0U);
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
