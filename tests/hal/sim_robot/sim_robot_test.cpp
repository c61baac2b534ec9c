// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/sim_robot.hpp"

#include <gtest/gtest.h>

#include "hal/sim_robot/cell.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::test {
namespace {

TEST(SimRobot, executes_a_streamed_path_point_by_point_and_in_time) {
  LinkCell cell;
  const auto points = round_weld(2500, 4000);

  ASSERT_EQ(cell.run({7, 1, points, true}, 30'000), link::WeldProgress::kDone);

  const auto executed = cell.robot_.executed();
  ASSERT_EQ(executed.size(), points.size());
  const std::int64_t start_ns = executed[0].at_ns;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(executed[i].due.index, i);
    ASSERT_EQ(executed[i].due.arc_on, points[i].arc);
    ASSERT_NEAR(static_cast<double>(executed[i].at_ns - start_ns), points[i].t_us * 1e3, 1.1e6);
    ASSERT_LE((executed[i].due.point.pose.p_base - points[i].pose.p_base).norm(), 0.001);
  }
}

TEST(SimRobot, reports_where_it_is_in_the_hosts_time) {
  LinkCell cell;
  const auto points = round_weld(2500, 4000);

  for (int i = 0; i < 6000; ++i) {
    cell.step({7, 1, points, true});
  }

  const link::PoseReport& pose = cell.sender_.pose();
  // One report every 20 ms at 40 mm/s.
  EXPECT_LT((pose.pose.p_base - cell.robot_.pose().p_base).norm(), 0.9);
  EXPECT_NEAR(pose.pose.p_base.z(), 300.0, 0.01);
  EXPECT_LT(std::abs(cell.sender_.clock_offset_ns()), 2'000'000);
}

TEST(SimRobot, a_step_allocates_nothing) {
  LinkCell cell;
  const auto points = round_weld(1000, 4000);
  const link::WeldOrder weld{7, 1, points, true};
  const AllocationCounter counter;

  ASSERT_EQ(cell.run(weld, 30'000), link::WeldProgress::kDone);

  EXPECT_EQ(counter.count(), 0U);
}

TEST(SimRobot, is_enabled_until_somebody_stops_it) {
  LinkCell cell;
  const auto points = round_weld(2500, 4000);
  const link::WeldOrder weld{7, 1, points, true};
  while (!cell.robot_.receiver().arc_on()) {
    ASSERT_EQ(cell.step(weld), link::WeldProgress::kUnderWay);
  }
  const link::RobotCondition before = cell.sender_.status().condition;

  cell.robot_.report_condition({.enabled = true, .emergency_stop = true});
  for (int i = 0; i < 3; ++i) {
    cell.step(weld);
  }

  EXPECT_EQ(before, link::RobotCondition{.enabled = true});
  EXPECT_TRUE(cell.sender_.status().condition.emergency_stop);
}

TEST(SimRobot, bus_off_ends_the_weld_on_both_sides_with_its_name) {
  LinkCell cell;
  const auto points = round_weld(2500, 4000);
  while (!cell.robot_.receiver().arc_on()) {
    ASSERT_EQ(cell.step({7, 1, points, true}), link::WeldProgress::kUnderWay);
  }

  cell.bus_.set_state(hal::BusState::kBusOff);
  cell.step({7, 1, points, true});

  EXPECT_FALSE(cell.robot_.receiver().arc_on());
  EXPECT_EQ(cell.robot_.receiver().fault(), link::Fault::kBusLost);
  EXPECT_EQ(cell.sender_.fault(), link::Fault::kBusLost);
}

}  // namespace
}  // namespace dseam::test
