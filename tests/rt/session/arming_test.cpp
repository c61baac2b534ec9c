// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "dseam/rt/weld_session.hpp"
#include "rt/session/welding.hpp"

namespace {

using dseam::link::RobotCondition;
using dseam::rt::Fault;
using dseam::rt::WeldSession;
using dseam::test::kMs;
using dseam::test::VirtualCell;
using dseam::test::weld_half;
using dseam::test::weld_to_the_end;
using dseam::test::with_vision;
using E = dseam::rt::SessionEvent;
using S = dseam::rt::SessionState;

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

TEST(WeldSession, a_robot_that_says_it_is_not_ready_is_not_armed_and_may_be_once_it_is) {
  const struct {
    RobotCondition condition;
    Fault name;
  } rows[] = {{{.enabled = true, .emergency_stop = true}, Fault::kRobotEmergencyStop},
              {{.enabled = true, .protective_stop = true}, Fault::kRobotProtectiveStop},
              {{.enabled = false}, Fault::kRobotNotEnabled},
              {{false, true, true}, Fault::kRobotEmergencyStop}};
  for (const auto& row : rows) {
    VirtualCell cell(30);
    cell.robot_trouble.condition = row.condition;
    ASSERT_TRUE(cell.bring_to(S::kPlanned));
    cell.inputs.operator_enable = true;
    cell.run(50 * kMs);

    EXPECT_FALSE(cell.session.order(E::kArm).ok());
    EXPECT_EQ(cell.session.health().robot_fault, row.name);
    EXPECT_EQ(cell.session.fault(), Fault::kNone);  // Nothing was armed that could be at fault.
    cell.robot_trouble.condition = {.enabled = true};
    cell.run(5 * kMs);
    EXPECT_TRUE(cell.session.order(E::kArm).ok());
    EXPECT_EQ(cell.session.health().robot_fault, Fault::kNone);
  }
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

TEST(WeldSession, a_robot_that_never_acknowledges_is_neither_armed_nor_moved) {
  VirtualCell cell(33);
  ASSERT_TRUE(cell.bring_to(S::kPlanned));
  cell.robot_trouble.impostor = cell.sender().status();  // The same for ever, though it lives.
  cell.inputs.operator_enable = true;
  cell.cycle();
  ASSERT_TRUE(cell.session.order(E::kArm).ok());

  ASSERT_TRUE(cell.run_until([&] { return cell.session.state() == S::kSafe; }, 5000 * kMs));

  EXPECT_EQ(cell.session.fault(), Fault::kLinkLost);
  EXPECT_EQ(cell.executed(), 0U);
  EXPECT_EQ(cell.arc_on_ns(), 0);
  EXPECT_EQ(cell.breach(), "");
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

TEST(WeldSession, a_second_greeting_replaces_the_first) {
  VirtualCell cell(24);

  EXPECT_TRUE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  EXPECT_TRUE(cell.session.connect(cell.new_session(), cell.now_ns()).ok());
  cell.run(300 * kMs);
  EXPECT_EQ(cell.sender().state(), dseam::link::HostState::kIdle);
}

}  // namespace
