// SPDX-License-Identifier: Apache-2.0
#include "robot/weld_run.hpp"

#include <gtest/gtest.h>

#include "job/motion_job.hpp"
#include "program/support/nozzle_job.hpp"
#include "robot/sim_robot_side.hpp"

namespace dseam::program {
namespace {

class WeldRunTest : public ::testing::Test {
 protected:
  WeldRunTest() : motion_(settings_, nozzle_.job.seam_base) { (void)motion_.plan(); }

  WeldOutcome run(const WeldRun::Progress& progress) {
    side_.emplace(motion_.points().front().pose);
    WeldRun weld(settings_.session, *side_, side_->bus(), interrupted_);
    return weld.run([this](const torch::TorchPose& now) { return motion_.plan_from(now); },
                    progress);
  }

  Settings settings_;
  test::NozzleJob nozzle_;
  MotionJob motion_;
  std::atomic<bool> interrupted_{false};
  std::optional<SimRobotSide> side_;
};

TEST_F(WeldRunTest, the_robot_executes_every_set_point_and_ends_with_the_arc_off) {
  const WeldOutcome outcome = run([](std::size_t, std::size_t) {});

  EXPECT_TRUE(outcome.finished) << rt::name(outcome.fault);
  EXPECT_EQ(side_->robot().executed().size(), motion_.points().size());
  EXPECT_FALSE(side_->robot().receiver().arc_on());
}

TEST_F(WeldRunTest, an_interrupt_while_the_arc_burns_turns_it_off_within_a_cycle) {
  std::int64_t interrupted_ns = 0;
  const WeldOutcome outcome = run([&](std::size_t, std::size_t) {
    if (side_->robot().receiver().arc_on() && !interrupted_) {
      interrupted_ns = side_->clock().now_ns();
      interrupted_ = true;
    }
  });

  EXPECT_TRUE(outcome.interrupted);
  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.fault, rt::Fault::kOperator);
  ASSERT_GT(interrupted_ns, 0);
  std::int64_t last_arc_ns = 0;
  for (const hal::sim::ExecutedPoint& point : side_->robot().executed()) {
    last_arc_ns = point.due.arc_on ? point.at_ns : last_arc_ns;
  }
  EXPECT_LE(last_arc_ns - interrupted_ns, 10'000'000);
  EXPECT_FALSE(side_->robot().receiver().arc_on());
  EXPECT_LE(side_->clock().now_ns() - interrupted_ns, 1'000'000'000);
}

}  // namespace
}  // namespace dseam::program
