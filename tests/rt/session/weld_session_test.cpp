// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/weld_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rt/session/cell/faults.hpp"
#include "rt/session/welding.hpp"
#include "support/allocation_counter.hpp"

namespace {

using dseam::rt::Fault;
using dseam::rt::WeldSession;
using dseam::test::FaultKind;
using dseam::test::kMs;
using dseam::test::VirtualCell;
using dseam::test::weld_half;
using dseam::test::weld_to_the_end;
using dseam::test::with_vision;
using E = dseam::rt::SessionEvent;
using S = dseam::rt::SessionState;

TEST(WeldSession, welds_the_whole_path_and_comes_back_to_idle) {
  VirtualCell cell(1);

  const bool idle = weld_to_the_end(cell);

  EXPECT_TRUE(idle) << name(cell.session.state()) << " " << name(cell.session.fault());
  EXPECT_EQ(cell.executed(), cell.path_points());
  EXPECT_EQ(cell.session.fault(), Fault::kNone);
  EXPECT_GT(cell.arc_on_ns(), 900 * kMs);
  EXPECT_EQ(cell.breach(), "");
}

TEST(WeldSession, each_fault_while_welding_ends_safe_under_its_own_name_or_is_borne_and_counted) {
  for (const FaultKind& kind : dseam::test::fault_kinds()) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      VirtualCell cell(seed, with_vision());
      ASSERT_TRUE(weld_half(cell)) << kind.name;
      const std::uint64_t before = kind.counted ? kind.counted(cell) : 0;
      const std::uint64_t tampered = cell.bus.injected;

      kind.begin(cell);
      cell.run(kind.lasts_ns);
      const Fault found = cell.session.fault();
      kind.end(cell);
      cell.run(1500 * kMs);

      EXPECT_NE(std::find(kind.expected.begin(), kind.expected.end(), found), kind.expected.end())
          << kind.name << " gave " << name(found) << ", seed " << seed;
      EXPECT_EQ(cell.session.state(), found == Fault::kNone ? S::kIdle : S::kSafe) << kind.name;
      EXPECT_FALSE(cell.arc_on()) << kind.name;
      EXPECT_EQ(cell.breach(), "") << kind.name;
      if (found == Fault::kNone) {
        ASSERT_TRUE(kind.counted) << kind.name;
        const std::uint64_t counted = kind.counted(cell) - before;
        EXPECT_TRUE(kind.each ? counted == cell.bus.injected - tampered : counted > 0)
            << kind.name << ": " << counted << " of " << cell.bus.injected - tampered << ", seed "
            << seed;
      }
    }
  }
}

TEST(WeldSession, a_torch_that_leaves_the_box_of_the_arc_gate_loses_the_arc) {
  WeldSession::Config config;
  config.arc.workspace.high_mm.x() = 18.0;
  VirtualCell cell(26, config);
  ASSERT_TRUE(weld_half(cell));

  cell.run(400 * kMs);

  EXPECT_EQ(cell.session.fault(), Fault::kOutsideWorkspace);
  EXPECT_FALSE(cell.arc_on());
}

TEST(WeldSession, a_torch_that_stands_is_named_when_no_other_limit_finds_it_first) {
  WeldSession::Config config;
  config.arc.max_standing_ns = 100 * kMs;
  config.arc.max_corridor_mm = config.arc.max_tracking_mm = 100.0;
  VirtualCell cell(27, config);
  ASSERT_TRUE(weld_half(cell));
  cell.robot_trouble.frozen = true;

  cell.run(150 * kMs);

  EXPECT_EQ(cell.session.fault(), Fault::kStandstill);
  EXPECT_FALSE(cell.arc_on());
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

TEST(WeldSession, the_arc_goes_off_where_the_set_points_say_that_the_seam_is_in_doubt) {
  VirtualCell cell(24);
  (void)cell.session.order(E::kScan);
  std::vector<dseam::trajectory::SetPoint> points(cell.points().begin(), cell.points().end());
  const std::size_t doubt = points.size() / 2;
  ASSERT_TRUE(points[doubt].arc);
  for (std::size_t i = doubt; i < doubt + 10; ++i) {
    points[i].confidence = dseam::seam::Confidence::kNone;
  }
  ASSERT_TRUE(cell.session.plan(points.front().pose, points).ok());
  (void)cell.session.connect(cell.new_session(), cell.now_ns());
  cell.run(300 * kMs);
  ASSERT_TRUE(cell.bring_to(S::kRunning));

  cell.run_until([&] { return cell.session.fault() != Fault::kNone; }, 4000 * kMs);
  const std::size_t executed = cell.executed();
  cell.run(1500 * kMs);

  EXPECT_EQ(cell.session.fault(), Fault::kConfidenceLow);
  EXPECT_GE(executed, doubt);
  EXPECT_LE(executed, doubt + 4);  // A status every 5 ms, a set point every 10.
  EXPECT_FALSE(cell.arc_on());
  EXPECT_EQ(cell.breach(), "");
}

TEST(WeldSession, frames_lost_for_want_of_room_trip_while_armed_and_are_counted_before) {
  VirtualCell cell(25);
  ASSERT_TRUE(cell.bring_to(S::kPlanned));
  cell.bus.trouble.flood = 600U;
  cell.run(2 * kMs);
  cell.bus.trouble.flood = 0U;
  cell.run(50 * kMs);
  const Fault before = cell.session.fault();
  ASSERT_GT(cell.session.health().receive_overflow, 0U);
  ASSERT_TRUE(cell.bring_to(S::kArmed));
  cell.bus.trouble.flood = 600U;

  cell.run(1 * kMs);

  EXPECT_EQ(before, Fault::kNone);
  EXPECT_EQ(cell.session.fault(), Fault::kRxOverflow);
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

TEST(WeldSession, stop_during_start_ends_at_rest) {
  VirtualCell cell(14);
  ASSERT_TRUE(cell.bring_to(S::kLoading));
  ASSERT_TRUE(cell.session.order(E::kStart).ok());
  ASSERT_TRUE(cell.session.order(E::kStop).ok());

  EXPECT_TRUE(cell.run_until([&] { return cell.session.state() == S::kIdle; }, 3000 * kMs));
  EXPECT_FALSE(cell.arc_on());
  EXPECT_EQ(cell.breach(), "");
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

TEST(WeldSession, a_robot_that_was_stopped_loses_the_arc_in_the_cycle_that_hears_of_it) {
  const dseam::link::RobotCondition conditions[] = {{.enabled = true, .emergency_stop = true},
                                                    {.enabled = true, .protective_stop = true},
                                                    {.enabled = false}};
  const std::uint32_t abort_id = dseam::link::Addressing{}.id_of(dseam::link::MessageId::kAbort);
  for (const auto& condition : conditions) {
    VirtualCell cell(31);
    ASSERT_TRUE(weld_half(cell));
    cell.robot_trouble.condition = condition;

    ASSERT_TRUE(
        cell.run_until([&] { return cell.sender().status().condition == condition; }, 2 * kMs));

    EXPECT_NE(cell.session.fault(), Fault::kNone);
    EXPECT_FALSE(cell.session.health().arc_permitted);
    ASSERT_FALSE(cell.bus.sent_this_cycle.empty());
    EXPECT_EQ(cell.bus.sent_this_cycle.front().id, abort_id);
    cell.run(2 * kMs);
    EXPECT_FALSE(cell.arc_on());
    EXPECT_EQ(cell.breach(), "");
  }
}

TEST(WeldSession, a_robot_that_is_stopped_before_it_moves_is_latched_as_well) {
  for (const S state : {S::kArmed, S::kLoading}) {
    VirtualCell cell(32);
    ASSERT_TRUE(cell.bring_to(state));
    cell.robot_trouble.condition.emergency_stop = true;

    cell.run(5 * kMs);
    cell.robot_trouble.condition.emergency_stop = false;
    cell.run(500 * kMs);

    EXPECT_EQ(cell.session.fault(), Fault::kRobotEmergencyStop);
    EXPECT_EQ(cell.session.state(), S::kSafe);
  }
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

}  // namespace
