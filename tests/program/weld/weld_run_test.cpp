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
    WeldRun weld(settings_.session, *side_, side_->bus(), *enable_, interrupted_);
    return weld.run([this](const torch::TorchPose& now) { return motion_.plan_from(now); },
                    progress);
  }

  Settings settings_;
  test::NozzleJob nozzle_;
  MotionJob motion_;
  std::atomic<bool> interrupted_{false};
  std::optional<SimRobotSide> side_;
  std::unique_ptr<OperatorEnable> enable_ = std::make_unique<WaivedEnable>();
};

/// Gives the enable at its first being asked and takes it back when told.
class HeldByHand final : public OperatorEnable {
 public:
  explicit HeldByHand(bool& held) : held_(held) {}
  void ask() noexcept override { held_ = true; }
  [[nodiscard]] bool held() const noexcept override { return held_; }

 private:
  bool& held_;
};

TEST_F(WeldRunTest, the_robot_executes_every_set_point_and_ends_with_the_arc_off) {
  const WeldOutcome outcome = run([](std::size_t, std::size_t) {});

  EXPECT_TRUE(outcome.finished) << rt::name(outcome.fault);
  EXPECT_EQ(side_->robot().executed().size(), motion_.points().size());
  EXPECT_FALSE(side_->robot().receiver().arc_on());
}

TEST_F(WeldRunTest, the_arc_goes_off_where_the_seam_is_less_certain_than_configured) {
  settings_.session.session.arc.min_confidence = seam::Confidence::kHigh;
  std::vector<seam::SeamPoint> points(nozzle_.job.seam_base.points.begin(),
                                      nozzle_.job.seam_base.points.end());
  for (std::size_t i = points.size() / 3; i < points.size() / 2; ++i) {
    points[i].confidence = seam::Confidence::kMedium;
  }
  seam::SeamView seam = nozzle_.job.seam_base;
  seam.points = points;
  MotionJob doubtful(settings_, seam);
  side_.emplace(doubtful.plan().front().pose);
  WeldRun weld(settings_.session, *side_, side_->bus(), *enable_, interrupted_);

  const WeldOutcome outcome =
      weld.run([&](const torch::TorchPose& now) { return doubtful.plan_from(now); },
               [](std::size_t, std::size_t) {});

  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.fault, rt::Fault::kConfidenceLow);
  EXPECT_GT(side_->robot().executed().size(), doubtful.points().size() / 4);
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

TEST_F(WeldRunTest, an_enable_that_is_taken_back_while_the_arc_burns_stops_the_weld) {
  bool held = false;
  enable_ = std::make_unique<HeldByHand>(held);

  const WeldOutcome outcome =
      run([&](std::size_t, std::size_t) { held = held && !side_->robot().receiver().arc_on(); });

  EXPECT_TRUE(outcome.released);
  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.fault, rt::Fault::kNone);
  EXPECT_FALSE(outcome.health.arc_on);
  EXPECT_FALSE(side_->robot().receiver().arc_on());
  EXPECT_LT(side_->robot().executed().size(), motion_.points().size());
}

TEST_F(WeldRunTest, an_emergency_stop_of_the_robot_ends_the_weld_under_its_name) {
  const WeldOutcome outcome = run([&](std::size_t, std::size_t) {
    if (side_->robot().receiver().arc_on()) {
      side_->robot().report_condition({.enabled = true, .emergency_stop = true});
    }
  });

  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.fault, rt::Fault::kRobotEmergencyStop);
  EXPECT_EQ(outcome.health.robot_fault, rt::Fault::kRobotEmergencyStop);
  EXPECT_FALSE(outcome.health.arc_on);
  EXPECT_LT(side_->robot().executed().size(), motion_.points().size());
}

TEST_F(WeldRunTest, a_robot_that_is_not_enabled_is_never_armed_and_named) {
  side_.emplace(motion_.points().front().pose);
  side_->robot().report_condition({.enabled = false});
  WeldRun weld(settings_.session, *side_, side_->bus(), *enable_, interrupted_);

  const WeldOutcome outcome =
      weld.run([this](const torch::TorchPose& now) { return motion_.plan_from(now); },
               [](std::size_t, std::size_t) {});

  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.fault, rt::Fault::kNone);
  EXPECT_EQ(outcome.health.robot_fault, rt::Fault::kRobotNotEnabled);
  EXPECT_TRUE(side_->robot().executed().empty());
}

TEST_F(WeldRunTest, without_an_enable_the_robot_is_never_armed) {
  class Nobody final : public OperatorEnable {
   public:
    void ask() noexcept override {}
    [[nodiscard]] bool held() const noexcept override { return false; }
  };
  enable_ = std::make_unique<Nobody>();

  const WeldOutcome outcome = run([](std::size_t, std::size_t) {});

  EXPECT_FALSE(outcome.finished);
  EXPECT_TRUE(side_->robot().executed().empty());
}

}  // namespace
}  // namespace dseam::program
