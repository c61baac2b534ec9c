// SPDX-License-Identifier: Apache-2.0
// As the robot sees it: differences of the samples. A difference quotient is a mean, so what it
// exceeds the trajectory exceeds; exact_limits_test.cpp has the peaks that a mean hides.
#include <gtest/gtest.h>

#include <algorithm>

#include "dseam/trajectory/sampler.hpp"
#include "random_path.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::torch::PathPoint;
using dseam::trajectory::Limits;
using dseam::trajectory::Sampler;
using dseam::trajectory::SetPoint;
using dseam::trajectory::TimeScaling;
using Eigen::Vector3d;

constexpr double kPaths = 10'000;
constexpr double kAllowed = 1.001;

std::vector<SetPoint> samples_of(const TimeScaling& timing, std::uint32_t period_us) {
  Sampler sampler = Sampler::make(timing.timed_path(), {}, period_us).value();
  std::vector<SetPoint> points(sampler.size());
  dseam::Buffer<SetPoint> out(points);
  EXPECT_TRUE(sample_all(sampler, out));
  return points;
}

struct Excess {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double angular_speed = 0.0;
  double angular_acceleration = 0.0;
};

Vector3d turn(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::AngleAxisd d(a.conjugate() * b);
  return d.angle() > M_PI ? Vector3d((d.angle() - 2.0 * M_PI) * d.axis())
                          : Vector3d(d.angle() * d.axis());
}

/// The largest share of each limit that differences over `dt_s` use.
Excess largest(const std::vector<SetPoint>& points, const Limits& limits, double dt_s) {
  Excess most;
  Vector3d v = Vector3d::Zero();
  Vector3d a = Vector3d::Zero();
  Vector3d w = Vector3d::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d v1 = (points[i].pose.p_base - points[i - 1].pose.p_base) / dt_s;
    const Vector3d a1 = (v1 - v) / dt_s;
    const Vector3d j1 = (a1 - a) / dt_s;
    const Vector3d w1 = turn(points[i - 1].pose.q_base_torch, points[i].pose.q_base_torch) / dt_s;
    most.speed = std::max(most.speed, v1.norm() / limits.speed_mm_s);
    most.acceleration = std::max(most.acceleration, a1.norm() / limits.acceleration_mm_s2);
    most.jerk = std::max(most.jerk, j1.norm() / limits.jerk_mm_s3);
    most.angular_speed = std::max(most.angular_speed, w1.norm() / limits.angular_speed_rad_s);
    most.angular_acceleration = std::max(
        most.angular_acceleration, (w1 - w).norm() / dt_s / limits.angular_acceleration_rad_s2);
    v = v1;
    a = a1;
    w = w1;
  }
  return most;
}

TEST(Limits, are_kept_on_ten_thousand_random_paths) {
  dseam::test::ArenaOwner owner(64 << 20);
  Excess worst;
  double moved_mm = 0.0;
  dseam::Pcg32 random(20'240'601);
  for (int n = 0; n < kPaths; ++n) {
    dseam::test::ArenaOwner each(TimeScaling::bytes(400));
    const Limits limits = dseam::test::random_limits(random);
    const auto path = dseam::test::random_path(random);
    TimeScaling timing = TimeScaling::make(limits, 400, each.arena()).value();
    const auto report = timing.run(path);
    ASSERT_EQ(report.state, TimeScaling::State::kTimed) << n;
    const auto period_us =
        static_cast<std::uint32_t>(std::clamp(report.duration_s * 1e6 / 1000.0, 50.0, 20'000.0));
    const auto points = samples_of(timing, period_us);
    const Excess e = largest(points, limits, 1e-6 * period_us);
    worst.speed = std::max(worst.speed, e.speed);
    worst.acceleration = std::max(worst.acceleration, e.acceleration);
    worst.jerk = std::max(worst.jerk, e.jerk);
    worst.angular_speed = std::max(worst.angular_speed, e.angular_speed);
    worst.angular_acceleration = std::max(worst.angular_acceleration, e.angular_acceleration);
    moved_mm += report.length_mm;
    EXPECT_LT((points.back().pose.p_base - path.back().pose.p_base).norm(), 1e-6) << n;
  }
  RecordProperty("worst_speed_share", std::to_string(worst.speed));
  RecordProperty("worst_acceleration_share", std::to_string(worst.acceleration));
  RecordProperty("worst_jerk_share", std::to_string(worst.jerk));
  RecordProperty("worst_angular_speed_share", std::to_string(worst.angular_speed));
  RecordProperty("worst_angular_acceleration_share", std::to_string(worst.angular_acceleration));

  EXPECT_LT(worst.speed, kAllowed);
  EXPECT_LT(worst.acceleration, kAllowed);
  EXPECT_LT(worst.jerk, kAllowed);
  EXPECT_LT(worst.angular_speed, kAllowed);
  EXPECT_LT(worst.angular_acceleration, kAllowed);
  EXPECT_GT(worst.speed, 0.9);  // Kept, and not by far.
  EXPECT_GT(worst.acceleration, 0.9);
  EXPECT_GT(worst.jerk, 0.9);
  EXPECT_GT(worst.angular_speed, 0.9);
  EXPECT_GT(worst.angular_acceleration, 0.9);
  EXPECT_GT(moved_mm, 1e5);
}

}  // namespace
