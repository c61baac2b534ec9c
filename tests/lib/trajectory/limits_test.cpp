// SPDX-License-Identifier: Apache-2.0
// As the robot sees it: differences of the samples. A difference quotient is a mean, so what it
// exceeds the trajectory exceeds; exact_limits_test.cpp has the peaks that a mean hides.
#include <gtest/gtest.h>

#include <algorithm>

#include "dseam/trajectory/sampler.hpp"
#include "limit_shares.hpp"
#include "random_path.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::test::LimitShares;
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

Vector3d turn(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::AngleAxisd d(a.conjugate() * b);
  return d.angle() > M_PI ? Vector3d((d.angle() - 2.0 * M_PI) * d.axis())
                          : Vector3d(d.angle() * d.axis());
}

LimitShares shares_of(const std::vector<SetPoint>& points, const Limits& limits, double dt_s) {
  LimitShares worst(limits);
  Vector3d v = Vector3d::Zero();
  Vector3d a = Vector3d::Zero();
  Vector3d w = Vector3d::Zero();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d v1 = (points[i].pose.p_base - points[i - 1].pose.p_base) / dt_s;
    const Vector3d a1 = (v1 - v) / dt_s;
    const Vector3d w1 = turn(points[i - 1].pose.q_base_torch, points[i].pose.q_base_torch) / dt_s;
    worst.add_speed(v1);
    worst.add_acceleration(a1);
    worst.add_jerk((a1 - a) / dt_s);
    worst.add_angular_speed(w1);
    worst.add_angular_acceleration((w1 - w) / dt_s);
    v = v1;
    a = a1;
    w = w1;
  }
  return worst;
}

TEST(Limits, are_kept_on_ten_thousand_random_paths) {
  LimitShares worst;
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
    worst.add(shares_of(points, limits, 1e-6 * period_us));
    moved_mm += report.length_mm;
    EXPECT_LT((points.back().pose.p_base - path.back().pose.p_base).norm(), 1e-6) << n;
  }

  worst.expect_between(0.9, kAllowed);  // Kept, and not by far.
  EXPECT_GT(moved_mm, 1e5);
}

}  // namespace
