// SPDX-License-Identifier: Apache-2.0
// Host and robot joined frame by frame, in virtual time.
#include "lib/link/loopback.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/allocation_counter.hpp"

namespace dseam::link {
namespace {

class Loopback : public LoopbackCell, public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    host_config_.addressing.classic = GetParam();
    robot_config_.addressing.classic = GetParam();
    rebuild();
  }
};

INSTANTIATE_TEST_SUITE_P(Bus, Loopback, ::testing::Values(false, true),
                         [](const auto& bus) { return bus.param ? "Classic" : "Fd"; });

TEST_P(Loopback, every_point_is_executed_once_in_order_and_at_its_time) {
  const auto points = straight_weld(1000, 4000);

  ASSERT_TRUE(prepare_and_start(points));
  ASSERT_TRUE(run_until(HostState::kDone, 10'000));

  ASSERT_EQ(executed_.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(executed_[i].index, i);
    ASSERT_EQ(executed_[i].point.t_us, points[i].t_us);
    ASSERT_EQ(executed_[i].arc_on, points[i].arc);
  }
  EXPECT_FALSE(robot_.arc_on());
  EXPECT_EQ(robot_.report().trips, 0U);
}

TEST_P(Loopback, nothing_allocates_after_both_ends_are_made) {
  const auto points = straight_weld(400, 4000);
  const test::AllocationCounter counter;

  ASSERT_TRUE(prepare_and_start(points));
  ASSERT_TRUE(run_until(HostState::kDone, 10'000));

  EXPECT_EQ(counter.count(), 0U);
}

TEST_P(Loopback, without_the_permit_the_path_is_driven_with_the_arc_off) {
  const auto points = straight_weld(200, 4000);

  ASSERT_TRUE(prepare(points));
  ASSERT_TRUE(host_.start(now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kDone));

  for (const DuePoint& due : executed_) {
    ASSERT_FALSE(due.arc_on);
  }
}

TEST_P(Loopback, a_silent_host_stops_the_robot_within_the_limit_and_the_arc_goes_off_first) {
  const auto points = straight_weld(1000, 4000);
  ASSERT_TRUE(prepare_and_start(points));
  while (!robot_.arc_on()) {
    step();
  }

  host_to_robot_ = false;
  const std::int64_t cut_ns = now_ns_;
  while (robot_.arc_on()) {
    step();
  }
  const std::int64_t dark_ns = now_ns_;
  while (robot_.moving()) {
    step();
  }

  EXPECT_LE(dark_ns - cut_ns, robot_config_.silence_limit_ns + kStepNs);
  EXPECT_EQ(robot_.state(), RobotState::kSafe);
  EXPECT_EQ(robot_.fault(), Fault::kCommandSilent);
  EXPECT_LE(now_ns_ - dark_ns, robot_config_.stop_ns + kStepNs);
  EXPECT_EQ(host_.state(), HostState::kSafe);
  EXPECT_EQ(host_.fault(), Fault::kPeerFault);
  EXPECT_EQ(host_.peer_fault(), Fault::kCommandSilent);
}

TEST_P(Loopback, a_silent_robot_sends_the_host_to_safe_within_the_limit) {
  const auto points = straight_weld(1000, 4000);
  ASSERT_TRUE(prepare_and_start(points));

  robot_to_host_ = false;
  const std::int64_t cut_ns = now_ns_;
  ASSERT_TRUE(run_until(HostState::kSafe));

  EXPECT_LE(now_ns_ - cut_ns, host_config_.silence_limit_ns + 2 * kStepNs);
  EXPECT_EQ(host_.fault(), Fault::kStatusSilent);
  step();
  EXPECT_EQ(robot_.fault(), Fault::kAborted);
  EXPECT_FALSE(robot_.arc_on());
}

TEST_P(Loopback, after_the_safe_state_only_a_new_session_leads_back) {
  const auto points = straight_weld(300, 4000);
  ASSERT_TRUE(prepare_and_start(points));
  host_.abort(Fault::kAborted, now_ns_);
  for (int i = 0; i < 500; ++i) {
    step();
  }
  ASSERT_EQ(robot_.state(), RobotState::kSafe);
  const std::size_t executed_before = executed_.size();

  EXPECT_FALSE(host_.arm(now_ns_).ok());
  EXPECT_FALSE(host_.connect(77, now_ns_).ok());
  ASSERT_TRUE(prepare(points, 78));

  EXPECT_EQ(robot_.state(), RobotState::kLoading);
  EXPECT_EQ(executed_.size(), executed_before);
  EXPECT_FALSE(robot_.arc_on());
}

TEST_P(Loopback, hold_stops_on_the_path_and_the_arc_waits_for_a_new_permit) {
  const auto points = straight_weld(1500, 4000);
  ASSERT_TRUE(prepare_and_start(points));
  while (!robot_.arc_on()) {
    step();
  }

  ASSERT_TRUE(host_.hold(now_ns_).ok());
  step();
  EXPECT_FALSE(robot_.arc_on());
  for (int i = 0; i < 400; ++i) {
    step();
  }
  EXPECT_FALSE(robot_.moving());
  EXPECT_EQ(robot_.state(), RobotState::kHold);
  ASSERT_TRUE(host_.start(now_ns_).ok());
  for (int i = 0; i < 300; ++i) {
    step();
  }
  EXPECT_TRUE(robot_.moving());
  EXPECT_FALSE(robot_.arc_on());
  host_.permit_weld(false);
  step();
  host_.permit_weld(true);
  for (int i = 0; i < 10; ++i) {
    step();
  }

  EXPECT_TRUE(robot_.arc_on());
}

TEST_P(Loopback, a_trajectory_with_a_bad_point_is_refused_before_anything_is_sent) {
  auto points = straight_weld(100, 4000);
  points[50].pose.p_base.x() = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(host_.connect(5, now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kIdle));
  ASSERT_TRUE(host_.arm(now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kArmed));

  const Result<> loaded = host_.load(points, 1, now_ns_);

  ASSERT_FALSE(loaded.ok());
  EXPECT_EQ(loaded.error(), Errc::kInvalidArgument);
  EXPECT_EQ(host_.state(), HostState::kArmed);
}

TEST_P(Loopback, what_was_expected_is_loaded_and_what_was_not_is_looked_at) {
  const auto points = straight_weld(200, 4000);
  auto bad = points;
  bad[100].t_us = bad[99].t_us;
  ASSERT_TRUE(prepare(points));

  EXPECT_TRUE(host_.expect(points).ok());
  EXPECT_EQ(host_.expect(bad).error(), Errc::kInvalidArgument);
  EXPECT_EQ(host_.expect({}).error(), Errc::kInvalidArgument);
  ASSERT_TRUE(host_.start(now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kDone));
  EXPECT_EQ(host_.load(bad, 2, now_ns_).error(), Errc::kInvalidArgument);
  EXPECT_TRUE(host_.load(points, 2, now_ns_).ok());
}

TEST_P(Loopback, what_the_robot_says_of_itself_is_heard_with_its_next_turn) {
  ASSERT_TRUE(host_.connect(5, now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kIdle));
  for (const RobotCondition condition : {RobotCondition{.enabled = true},
                                         {.enabled = true, .protective_stop = true},
                                         {false, false, true}}) {
    robot_.report_condition(condition);

    step();

    EXPECT_EQ(host_.status().condition, condition);
  }
}

TEST_P(Loopback, nobody_there_is_a_named_fault) {
  host_to_robot_ = false;
  ASSERT_TRUE(host_.connect(5, now_ns_).ok());

  ASSERT_TRUE(run_until(HostState::kSafe));

  EXPECT_EQ(host_.fault(), Fault::kNoPeer);
}

}  // namespace
}  // namespace dseam::link
