// SPDX-License-Identifier: Apache-2.0
// Samples show means of the derivatives. Here the derivatives themselves are asked for: on both
// sides of every moment at which the time law changes, and between.
#include <gtest/gtest.h>

#include "exact_motion.hpp"
#include "limit_shares.hpp"
#include "random_path.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::test::ExactLaw;
using dseam::test::ExactMotion;
using dseam::test::LimitShares;
using dseam::trajectory::Limits;
using dseam::trajectory::TimeScaling;
using Eigen::Vector3d;

constexpr int kPaths = 10'000;
constexpr double kAllowed = 1.001;
constexpr double kPlaces[] = {1e-6, 0.33, 0.67, 1.0 - 1e-6};

Vector3d turn(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return (d.w() < 0.0 ? -2.0 : 2.0) * d.vec();  // Small: the sine is the angle.
}

void look_at_turning(const ExactLaw& law, double t_s, double step_s, LimitShares& worst) {
  const Eigen::Quaterniond q[] = {law.at(t_s).q, law.at(t_s + step_s).q,
                                  law.at(t_s + 2.0 * step_s).q};
  const Vector3d w0 = turn(q[0], q[1]) / step_s;
  const Vector3d w1 = turn(q[1], q[2]) / step_s;
  worst.add_angular_speed(w0);
  worst.add_angular_acceleration((w1 - w0) / step_s);
}

LimitShares shares_of(const ExactLaw& law, const Limits& limits) {
  LimitShares worst(limits);
  const auto& breaks = law.breaks_s();
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    const double from_s = breaks[k - 1];
    const double long_s = breaks[k] - from_s;
    if (long_s < 1e-7) {
      continue;
    }
    for (const double place : kPlaces) {
      const ExactMotion now = law.at(from_s + place * long_s);
      worst.add_speed(now.velocity);
      worst.add_acceleration(now.acceleration);
      worst.add_jerk(now.jerk);
    }
    const double step_s = std::min(1e-4, 0.2 * long_s);
    if (step_s > 1e-5) {
      look_at_turning(law, from_s + 1e-6 * long_s, step_s, worst);
      look_at_turning(law, from_s + 0.5 * long_s, step_s, worst);
    }
  }
  return worst;
}

/// Times `count` random paths and hands over each law with its limits.
template <typename F>
void for_random_laws(int count, F look) {
  dseam::Pcg32 random(20'261'122);
  for (int n = 0; n < count; ++n) {
    dseam::test::ArenaOwner memory(TimeScaling::bytes(400));
    const Limits limits = dseam::test::random_limits(random);
    const auto path = dseam::test::random_path(random);
    TimeScaling timing = TimeScaling::make(limits, 400, memory.arena()).value();
    ASSERT_EQ(timing.run(path).state, TimeScaling::State::kTimed) << n;
    look(timing.timed_path(), limits);
  }
}

TEST(Limits, are_kept_by_the_derivatives_themselves_on_ten_thousand_random_paths) {
  LimitShares worst;

  for_random_laws(kPaths, [&](const auto& timed, const Limits& limits) {
    worst.add(shares_of(ExactLaw(timed), limits));
  });

  worst.expect_between(0.9, kAllowed);
}

TEST(Limits, a_path_begins_and_ends_without_speed_and_without_acceleration) {
  constexpr double kSoonS = 1e-5;
  for_random_laws(1000, [&](const auto& timed, const Limits& limits) {
    const ExactLaw law(timed);
    for (const double t_s : {kSoonS, timed.duration_s - kSoonS}) {
      const ExactMotion motion = law.at(t_s);

      EXPECT_LE(motion.acceleration.norm(), 1.01 * kSoonS * limits.jerk_mm_s3 + 1e-6);
      EXPECT_LE(motion.velocity.norm(), kSoonS * kSoonS * limits.jerk_mm_s3 + 1e-9);
    }
  });
}

}  // namespace
