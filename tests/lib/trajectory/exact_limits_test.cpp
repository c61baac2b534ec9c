// SPDX-License-Identifier: Apache-2.0
// Samples show means of the derivatives. Here the derivatives themselves are asked for: on both
// sides of every moment at which the time law changes, and between.
#include <gtest/gtest.h>

#include "exact_motion.hpp"
#include "random_path.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::test::ExactLaw;
using dseam::test::ExactMotion;
using dseam::trajectory::Limits;
using dseam::trajectory::TimeScaling;
using Eigen::Vector3d;

constexpr int kPaths = 10'000;
constexpr double kAllowed = 1.001;
constexpr double kPlaces[] = {1e-6, 0.33, 0.67, 1.0 - 1e-6};

struct Worst {
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double angular_speed = 0.0;
  double angular_acceleration = 0.0;
};

Vector3d turn(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return (d.w() < 0.0 ? -2.0 : 2.0) * d.vec();  // Small: the sine is the angle.
}

void look_at_turning(const ExactLaw& law, double t_s, double step_s, const Limits& limits,
                     Worst& worst) {
  const Eigen::Quaterniond q[] = {law.at(t_s).q, law.at(t_s + step_s).q,
                                  law.at(t_s + 2.0 * step_s).q};
  const Vector3d w0 = turn(q[0], q[1]) / step_s;
  const Vector3d w1 = turn(q[1], q[2]) / step_s;
  worst.angular_speed = std::max(worst.angular_speed, w0.norm() / limits.angular_speed_rad_s);
  worst.angular_acceleration = std::max(
      worst.angular_acceleration, (w1 - w0).norm() / step_s / limits.angular_acceleration_rad_s2);
}

void look_at(const ExactLaw& law, const Limits& limits, Worst& worst) {
  const auto& breaks = law.breaks_s();
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    const double from_s = breaks[k - 1];
    const double long_s = breaks[k] - from_s;
    if (long_s < 1e-7) {
      continue;
    }
    for (const double place : kPlaces) {
      const ExactMotion now = law.at(from_s + place * long_s);
      worst.speed = std::max(worst.speed, now.velocity.norm() / limits.speed_mm_s);
      worst.acceleration =
          std::max(worst.acceleration, now.acceleration.norm() / limits.acceleration_mm_s2);
      worst.jerk = std::max(worst.jerk, now.jerk.norm() / limits.jerk_mm_s3);
    }
    const double step_s = std::min(1e-4, 0.2 * long_s);
    if (step_s > 1e-5) {
      look_at_turning(law, from_s + 1e-6 * long_s, step_s, limits, worst);
      look_at_turning(law, from_s + 0.5 * long_s, step_s, limits, worst);
    }
  }
}

TEST(Limits, are_kept_by_the_derivatives_themselves_on_ten_thousand_random_paths) {
  Worst worst;
  dseam::Pcg32 random(20'261'122);
  for (int n = 0; n < kPaths; ++n) {
    dseam::test::ArenaOwner memory(TimeScaling::bytes(400));
    const Limits limits = dseam::test::random_limits(random);
    const auto path = dseam::test::random_path(random);
    TimeScaling timing = TimeScaling::make(limits, 400, memory.arena()).value();
    ASSERT_EQ(timing.run(path).state, TimeScaling::State::kTimed) << n;

    look_at(ExactLaw(timing.timed_path()), limits, worst);
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
  EXPECT_GT(worst.jerk, 0.9);  // It is looked at where it is greatest.
}

}  // namespace
