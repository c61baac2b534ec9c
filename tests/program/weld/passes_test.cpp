// SPDX-License-Identifier: Apache-2.0
// Passes, sectors, rows of welding parameters and a broken bead, from the configuration on.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "config/load.hpp"
#include "job/motion_job.hpp"
#include "program/support/nozzle_job.hpp"
#include "robot/sim_robot_side.hpp"

namespace dseam::program {
namespace {

constexpr double kRadiusMm = 40.0;  // Of the seam of NozzleJob, which is a circle about z.
constexpr double kTurnMm = 2.0 * std::numbers::pi * kRadiusMm;

Settings configured(std::initializer_list<const char*> assignments) {
  Settings settings;
  std::vector<Key> keys = keys_of(settings);
  for (const char* assignment : assignments) {
    set_key(assignment, keys);
  }
  check_together(settings, keys);
  return settings;
}

/// Where on the seam, from its first point; the other way round just before it.
double along_mm(const Eigen::Vector3d& p_base) {
  return kRadiusMm * std::atan2(p_base.y(), p_base.x());
}

TEST(Passes, a_list_gives_one_value_for_each_and_its_last_holds_for_the_rest) {
  const Settings settings =
      configured({"path.passes=3", "path.speed_mm_s=[8.0, 6, 5.5]", "path.pass_out_mm=[0.0, 3.0]",
                  "path.weave=sine", "path.weave_pitch_mm=4", "path.weave_amplitude_mm=[0, 2]"});

  const auto& passes = settings.motion.path.passes;
  EXPECT_EQ(settings.motion.path.num_passes, 3U);
  EXPECT_EQ(passes[1].speed_mm_s, 6.0);
  EXPECT_EQ(passes[2].speed_mm_s, 5.5);
  EXPECT_EQ(passes[2].out_mm, 3.0);
  EXPECT_EQ(passes[0].weave.amplitude_mm, 0.0);
  EXPECT_EQ(passes[2].weave.amplitude_mm, 2.0);
  EXPECT_EQ(passes[2].weave.shape, torch::WeaveShape::kSine);
}

TEST(Passes, each_is_welded_with_its_row_and_a_sector_with_a_row_of_its_own) {
  const Settings settings = configured(
      {"path.passes=2", "path.pass_schedule=[0, 1]", "weld.schedules=3",
       "weld.wire_feed_m_min=[6.0, 7.0, 4.0]", "path.sectors=1", "path.sector_from_mm=60",
       "path.sector_to_mm=90", "path.sector_pass=1", "path.sector_schedule=2"});
  const test::NozzleJob nozzle;
  MotionJob motion(settings, nozzle.job.seam_base);

  std::array<std::size_t, 3> burnt{};
  for (const trajectory::SetPoint& point : motion.plan()) {
    if (!point.arc || point.segment == torch::Segment::kCrater) {
      continue;
    }
    const double s_mm = along_mm(point.pose.p_base);
    const bool in_sector = s_mm > 61.0 && s_mm < 89.0;
    const bool at_its_ends = s_mm > 59.0 && s_mm < 91.0 && !in_sector;
    const double wanted = point.pass == 0 ? 6.0 : in_sector ? 4.0 : 7.0;
    EXPECT_TRUE(point.wire_feed_m_min == wanted || at_its_ends) << s_mm;
    ++burnt[point.schedule];
  }
  EXPECT_TRUE(burnt[0] > 0 && burnt[1] > 0 && burnt[2] > 0);
}

/// Welds until `stop_at` set points are executed; the number that were.
std::size_t weld_until(const Settings& settings, MotionJob& motion, std::size_t stop_at) {
  SimRobotSide side(motion.plan().front().pose);
  std::atomic<bool> interrupted{false};
  WaivedEnable enable;
  WeldRun weld(settings.session, side, side.bus(), enable, interrupted);
  const WeldOutcome outcome =
      weld.run([&](const torch::TorchPose& now) { return motion.plan_from(now); },
               [&](std::size_t done, std::size_t) { interrupted = done >= stop_at; });
  return outcome.executed;
}

/// Travel with the arc on.
double burning_mm(trajectory::SetPointView points) {
  double sum_mm = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    sum_mm += points[i].arc ? points[i + 1].s_mm - points[i].s_mm : 0.0;
  }
  return sum_mm;
}

struct Place {
  const char* name;
  double share;  ///< Of the set points that are executed before the interrupt.
};

class BrokenBeadTest : public ::testing::TestWithParam<Place> {};

TEST_P(BrokenBeadTest, is_taken_up_before_the_place_where_the_arc_went_off) {
  const test::NozzleJob nozzle;
  const Settings whole = configured({});
  MotionJob first(whole, nozzle.job.seam_base);
  const auto stop_at =
      static_cast<std::size_t>(GetParam().share * static_cast<double>(first.plan().size()));
  const std::size_t executed = weld_until(whole, first, stop_at);
  ASSERT_LT(executed, first.points().size());
  const double off_mm = along_mm(first.points()[executed - 1].pose.p_base);

  const auto broken = first.broken_after(executed);

  ASSERT_TRUE(broken);
  EXPECT_NEAR(std::remainder(broken->stopped_mm - off_mm, kTurnMm), 0.0, 0.1);
  const std::string stopped = "resume.stopped_mm=" + std::to_string(broken->stopped_mm);
  const Settings rest = configured({"resume.active=true", stopped.c_str()});
  MotionJob second(rest, nozzle.job.seam_base);
  ASSERT_FALSE(second.plan().empty()) << second.why();
  EXPECT_NEAR(second.report().path.weld_mm, burning_mm(first.points().subspan(executed)) + 5.0,
              0.5);
  const std::size_t done = weld_until(rest, second, 2 * second.points().size());
  EXPECT_EQ(done, second.points().size());
}

INSTANTIATE_TEST_SUITE_P(Places, BrokenBeadTest,
                         ::testing::Values(Place{"early", 0.15}, Place{"half_way", 0.5},
                                           Place{"late", 0.85}),
                         [](const auto& place) { return std::string(place.param.name); });

TEST(BrokenBead, within_the_overlap_lies_past_a_whole_turn) {
  const test::NozzleJob nozzle;
  MotionJob motion(configured({}), nozzle.job.seam_base);
  const trajectory::SetPointView points = motion.plan();
  const auto overlap = std::find_if(points.begin(), points.end(), [](const auto& point) {
    return point.segment == torch::Segment::kOverlap;
  });
  ASSERT_NE(overlap, points.end());

  const auto broken = motion.broken_after(static_cast<std::size_t>(overlap - points.begin()) + 1);

  ASSERT_TRUE(broken);
  EXPECT_NEAR(broken->stopped_mm, kTurnMm, 0.5);
}

TEST(BrokenBead, at_the_very_start_begins_anew) {
  const test::NozzleJob nozzle;
  MotionJob motion(configured({}), nozzle.job.seam_base);
  const trajectory::SetPointView points = motion.plan();
  const auto arc =
      std::find_if(points.begin(), points.end(), [](const auto& point) { return point.arc; });

  const auto broken = motion.broken_after(static_cast<std::size_t>(arc - points.begin()) + 1);

  ASSERT_TRUE(broken);
  EXPECT_NEAR(broken->stopped_mm, 0.0, 0.1);
  EXPECT_FALSE(motion.broken_after(static_cast<std::size_t>(arc - points.begin())));
}

TEST(BrokenBead, past_the_end_leaves_nothing_to_weld_and_that_is_said) {
  const test::NozzleJob nozzle;
  MotionJob motion(configured({"resume.active=true", "resume.stopped_mm=9000"}),
                   nozzle.job.seam_base);

  EXPECT_TRUE(motion.plan().empty());
  EXPECT_NE(motion.why().find("resume.stopped_mm"), std::string::npos);
}

}  // namespace
}  // namespace dseam::program
