// SPDX-License-Identifier: Apache-2.0
#include "dseam/trajectory/time_scaling.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "dseam/trajectory/sampler.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::torch::PathPoint;
using dseam::trajectory::LimitKind;
using dseam::trajectory::Limits;
using dseam::trajectory::Sampler;
using dseam::trajectory::SetPoint;
using dseam::trajectory::TimeScaling;
using State = TimeScaling::State;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// `count` points along x, `step_mm` apart.
std::vector<PathPoint> line(std::size_t count, double step_mm, double speed_mm_s) {
  std::vector<PathPoint> path(count);
  for (std::size_t i = 0; i < count; ++i) {
    path[i].s_mm = step_mm * static_cast<double>(i);
    path[i].pose.p_base.x() = path[i].s_mm;
    path[i].speed_mm_s = speed_mm_s;
  }
  return path;
}

struct Timed {
  TimeScaling::Report report;
  std::vector<SetPoint> points;
};

Timed time(const std::vector<PathPoint>& path, const Limits& limits = {},
           std::uint32_t period_us = 1000, const dseam::trajectory::WeldTable& table = {}) {
  dseam::test::ArenaOwner owner(TimeScaling::bytes(path.size() + 1));
  TimeScaling timing = TimeScaling::make(limits, path.size() + 1, owner.arena()).value();
  const dseam::test::AllocationCounter counter;
  Timed timed{timing.run(path), {}};
  EXPECT_EQ(counter.count(), 0U);
  if (timed.report.state == State::kTimed) {
    Sampler sampler = Sampler::make(timing.timed_path(), table, period_us).value();
    timed.points.resize(sampler.size());
    dseam::Buffer<SetPoint> out(timed.points);
    EXPECT_TRUE(sample_all(sampler, out));
  }
  return timed;
}

TEST(TimeScaling, runs_at_the_speed_asked_for_between_its_ramps) {
  const Timed timed = time(line(201, 0.5, 20.0));

  std::size_t steady = 0;
  for (const SetPoint& point : timed.points) {
    if (point.limited_by == LimitKind::kNone) {
      ++steady;
      EXPECT_NEAR(point.speed_mm_s, 20.0, 1e-6);
    }
  }
  EXPECT_GT(steady, timed.points.size() * 9 / 10);
}

TEST(TimeScaling, says_what_holds_it_back) {
  const struct {
    LimitKind kind;
    Limits limits;
  } cases[] = {{LimitKind::kSpeed, {.speed_mm_s = 10.0}},
               {LimitKind::kAcceleration, {.acceleration_mm_s2 = 5.0, .jerk_mm_s3 = 1e6}},
               {LimitKind::kJerk, {.jerk_mm_s3 = 20.0}},
               {LimitKind::kAngularSpeed, {.angular_speed_rad_s = 0.05}},
               {LimitKind::kAngularAcceleration, {.angular_acceleration_rad_s2 = 0.001}}};
  std::vector<PathPoint> circle(400);
  for (std::size_t i = 0; i < circle.size(); ++i) {
    circle[i].s_mm = 0.5 * static_cast<double>(i);
    const double angle = circle[i].s_mm / 30.0;
    circle[i].pose.p_base = {30.0 * std::cos(angle), 30.0 * std::sin(angle), 0.0};
    circle[i].pose.q_base_torch =
        Eigen::AngleAxisd(angle + 0.02 * std::sin(5.0 * angle), Eigen::Vector3d::UnitZ());
    circle[i].speed_mm_s = 20.0;
  }
  for (const auto& c : cases) {
    const Timed timed = time(circle, c.limits);

    ASSERT_EQ(timed.report.state, State::kTimed);
    EXPECT_GT(timed.report.slowed_mm[static_cast<std::size_t>(c.kind)], 50.0)
        << static_cast<int>(c.kind);
  }
}

TEST(TimeScaling, stands_at_a_stop_for_its_dwell_with_its_own_process) {
  auto path = line(41, 0.5, 20.0);
  path[20].stop = true;
  path[20].dwell_s = 0.25;
  path[20].gas = true;
  path.insert(path.begin() + 21, path[20]);
  path[21].arc = true;
  path[21].dwell_s = 0.5;
  path[21].schedule = 1;
  dseam::trajectory::WeldTable table;
  table.rows[1] = {7.5, 22.0};
  table.num_rows = 2;

  const Timed timed = time(path, {}, 1000, table);

  int gas_only = 0;
  int arc = 0;
  for (const SetPoint& point : timed.points) {
    const bool here = std::abs(point.s_mm - 10.0) < 1e-9 && point.speed_mm_s < 1e-9;
    gas_only += here && point.gas && !point.arc ? 1 : 0;
    if (here && point.arc) {
      ++arc;
      EXPECT_EQ(point.wire_feed_m_min, 7.5);
      EXPECT_EQ(point.voltage_v, 22.0);
    }
  }
  EXPECT_NEAR(gas_only, 250, 2);
  EXPECT_NEAR(arc, 500, 2);
  EXPECT_EQ(timed.report.stops, 2U);
}

TEST(TimeScaling, a_path_that_only_stands_is_timed_and_one_that_does_nothing_is_not) {
  auto standing = line(2, 0.0, 10.0);
  standing[0].dwell_s = 1.0;

  EXPECT_NEAR(time(standing).report.duration_s, 1.0, 1e-9);
  EXPECT_EQ(time(line(2, 0.0, 10.0)).report.state, State::kNoLength);
  EXPECT_EQ(time(line(1, 1.0, 10.0)).report.state, State::kTooFewPoints);
  EXPECT_EQ(time({}).report.state, State::kTooFewPoints);
}

TEST(TimeScaling, two_points_are_a_path) {
  const Timed timed = time(line(2, 30.0, 20.0));

  EXPECT_EQ(timed.report.state, State::kTimed);
  EXPECT_NEAR(timed.points.back().pose.p_base.x(), 30.0, 1e-9);
}

TEST(TimeScaling, bad_points_are_named) {
  const auto state_of = [](auto spoil) {
    auto path = line(10, 1.0, 10.0);
    spoil(path);
    return time(path).report.state;
  };

  EXPECT_EQ(state_of([](auto& p) { p[3].pose.p_base.x() = kNan; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[3].pose.q_base_torch.w() = 2.0; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[3].speed_mm_s = 0.0; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[3].speed_mm_s = kNan; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[3].s_mm = 1.0; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[3].dwell_s = -1.0; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[0].s_mm = kNan; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) { p[4].s_mm = p[3].s_mm; }), State::kBadPoint);
  EXPECT_EQ(state_of([](auto& p) {
              p[4] = p[3];
              p[4].pose.q_base_torch = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX());
            }),
            State::kTurnsOnTheSpot);
  EXPECT_EQ(state_of([](auto& p) {
              p[3].dwell_s = 1e9;
              p[3].stop = true;
            }),
            State::kTooLong);
}

TEST(TimeScaling, limits_of_zero_less_or_nothing_are_refused) {
  dseam::test::ArenaOwner owner(TimeScaling::bytes(10));
  const auto refused = [&](Limits limits) {
    return TimeScaling::make(limits, 10, owner.arena()).error() == dseam::Errc::kInvalidArgument;
  };

  EXPECT_TRUE(refused({.speed_mm_s = 0.0}));
  EXPECT_TRUE(refused({.acceleration_mm_s2 = -1.0}));
  EXPECT_TRUE(refused({.jerk_mm_s3 = kNan}));
  EXPECT_TRUE(refused({.angular_speed_rad_s = std::numeric_limits<double>::infinity()}));
  EXPECT_TRUE(refused({.angular_acceleration_rad_s2 = 0.0}));
}

TEST(TimeScaling, too_little_storage_is_named) {
  dseam::test::ArenaOwner owner(TimeScaling::bytes(10));
  TimeScaling timing = TimeScaling::make({}, 10, owner.arena()).value();
  dseam::test::ArenaOwner none(10);

  EXPECT_EQ(timing.run(line(1000, 1.0, 10.0)).state, State::kTooLong);
  EXPECT_TRUE(timing.timed_path().nodes.empty());
  EXPECT_EQ(TimeScaling::make({}, 10, none.arena()).error(), dseam::Errc::kOutOfMemory);
}

TEST(Sampler, does_not_drift_in_an_hour) {
  const Timed timed = time(line(7201, 5.0, 10.0), {}, 10'000);

  EXPECT_NEAR(timed.report.duration_s, 3600.0, 2.0);
  for (std::size_t i = 0; i < timed.points.size(); ++i) {
    ASSERT_EQ(timed.points[i].t_us, 10'000U * i);
    if (timed.points[i].limited_by == LimitKind::kNone) {
      const double expected_mm =
          10.0 * (1e-6 * timed.points[i].t_us) - 10.0 * (timed.report.duration_s / 2.0) + 18'000.0;
      ASSERT_NEAR(timed.points[i].s_mm, expected_mm, 1e-5);
    }
  }
}

TEST(Sampler, costs_at_most_two_hundredths_of_a_core_at_a_kilohertz) {
  const auto path = line(20'001, 0.05, 20.0);
  dseam::test::ArenaOwner owner(TimeScaling::bytes(path.size()));
  TimeScaling timing = TimeScaling::make({}, path.size(), owner.arena()).value();
  ASSERT_EQ(timing.run(path).state, State::kTimed);
  Sampler sampler = Sampler::make(timing.timed_path(), {}, 1000).value();
  SetPoint point;
  std::size_t count = 0;

  const auto begin = std::clock();
  while (sampler.next(point)) {
    ++count;
  }
  const double used_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;

  RecordProperty("ns_per_set_point", std::to_string(1e9 * used_s / static_cast<double>(count)));
  EXPECT_LT(used_s, 0.02 * 1e-3 * static_cast<double>(count));
}

TEST(Sampler, no_period_and_no_path_are_refused) {
  EXPECT_FALSE(Sampler::make({}, {}, 1000).ok());
  const auto path = line(10, 1.0, 10.0);
  dseam::test::ArenaOwner owner(TimeScaling::bytes(10));
  TimeScaling timing = TimeScaling::make({}, 10, owner.arena()).value();
  (void)timing.run(path);
  EXPECT_FALSE(Sampler::make(timing.timed_path(), {}, 0).ok());
}

TEST(WeldTable, a_row_that_is_not_there_feeds_nothing) {
  const dseam::trajectory::WeldTable table;

  EXPECT_EQ(table.at(200).wire_feed_m_min, 0.0);
  EXPECT_EQ(table.at(1).voltage_v, 0.0);
  EXPECT_GT(table.at(0).voltage_v, 0.0);
}

}  // namespace
