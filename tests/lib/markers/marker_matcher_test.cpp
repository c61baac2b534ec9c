// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/marker_matcher.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "dseam/base/random.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::markers {
namespace {

using Points = std::vector<Eigen::Vector3d>;

double between(Pcg32& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

// Discs on a shell of 108 mm radius, no two nearer than 12 mm.
Points field(int count, Pcg32& random) {
  Points out;
  while (static_cast<int>(out.size()) < count) {
    const double angle = between(random, -0.7, 0.7);
    const Eigen::Vector3d p(between(random, -110.0, 110.0), 108.0 * std::sin(angle),
                            108.0 * std::cos(angle));
    const bool crowded = std::any_of(
        out.begin(), out.end(), [&](const Eigen::Vector3d& q) { return (p - q).norm() < 12.0; });
    if (!crowded) {
      out.push_back(p);
    }
  }
  return out;
}

geometry::RigidTransform pose(Pcg32& random) {
  const Eigen::Vector3d turn(between(random, -2, 2), between(random, -1, 1),
                             between(random, -1, 1));
  return {geometry::rotation_exp(turn), Eigen::Vector3d(between(random, -300, 300), 50.0, 640.0)};
}

Points seen_from(const geometry::RigidTransform& T_a_b, const Points& in_a, double noise_mm,
                 Pcg32& random) {
  Points out;
  for (const Eigen::Vector3d& p : in_a) {
    const Eigen::Vector3d noise(between(random, -1, 1), between(random, -1, 1),
                                between(random, -1, 1));
    out.push_back(T_a_b.inverse() * p + noise_mm * noise);
  }
  return out;
}

struct Matched {
  MatchReport report;
  std::vector<MarkerPair> pairs;
};

Matched match(const Points& a, const Points& b,
              const std::optional<geometry::RigidTransform>& prior = std::nullopt) {
  test::ArenaOwner owner(MarkerMatcher::bytes(64));
  auto matcher = MarkerMatcher::make({}, 64, owner.arena());
  const test::AllocationCounter allocations;
  Matched out{matcher.value().run(a, b, prior), {}};
  EXPECT_EQ(allocations.count(), 0U);
  for (std::size_t i = 0; i < matcher.value().num_pairs(); ++i) {
    out.pairs.push_back(matcher.value().pair(i));
  }
  return out;
}

double worst_error(const geometry::RigidTransform& found, const geometry::RigidTransform& truth,
                   const Points& in_b) {
  double worst = 0.0;
  for (const Eigen::Vector3d& p : in_b) {
    worst = std::max(worst, (found * p - truth * p).norm());
  }
  return worst;
}

TEST(MarkerMatcher, finds_the_pose_with_a_third_missing_and_a_third_false) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Pcg32 random(seed);
    const Points all = field(18, random);
    const geometry::RigidTransform truth = pose(random);
    // Each side misses five or six of the shared ones and has five or six of its own.
    Points a(all.begin(), all.begin() + 13);
    Points b = seen_from(truth, Points(all.begin() + 5, all.end()), 0.03, random);
    const Points strangers = field(10, random);
    a.insert(a.end(), strangers.begin(), strangers.begin() + 5);
    const Points others = seen_from(pose(random), field(5, random), 0.0, random);
    b.insert(b.end(), others.begin(), others.end());

    const Matched found = match(a, b);

    ASSERT_EQ(found.report.state, MatchState::kMatched) << "seed " << seed;
    EXPECT_LT(worst_error(found.report.T_a_b, truth, Points(b.begin(), b.begin() + 13)), 0.15)
        << "seed " << seed;
    for (const MarkerPair& pair : found.pairs) {
      EXPECT_EQ(pair.a, pair.b + 5) << "seed " << seed;
    }
  }
}

TEST(MarkerMatcher, a_prior_decides_between_symmetric_assignments) {
  // Six discs evenly round a nozzle: every sixth of a turn fits.
  Points ring;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3.0;
    ring.emplace_back(70.0 * std::cos(angle), 70.0 * std::sin(angle), 0.0);
  }
  Pcg32 random(5);
  const geometry::RigidTransform truth = pose(random);
  const Points b = seen_from(truth, ring, 0.02, random);

  const Matched alone = match(ring, b);
  const Matched with_prior = match(ring, b, truth);

  EXPECT_EQ(alone.report.state, MatchState::kSymmetric);
  EXPECT_EQ(with_prior.report.state, MatchState::kMatched);
  EXPECT_LT(worst_error(with_prior.report.T_a_b, truth, b), 0.1);
}

TEST(MarkerMatcher, a_mirrored_field_is_named) {
  Pcg32 random(6);
  const Points a = field(12, random);
  Points b;
  for (const Eigen::Vector3d& p : a) {
    b.emplace_back(-p.x(), p.y(), p.z());
  }

  EXPECT_EQ(match(a, b).report.state, MatchState::kMirrored);
}

TEST(MarkerMatcher, markers_on_a_line_are_named) {
  const Points a{{0, 0, 500}, {31, 0, 500}, {75, 0, 500}, {140, 0, 500}};

  EXPECT_EQ(match(a, a).report.state, MatchState::kCollinear);
}

TEST(MarkerMatcher, three_markers_close_together_are_refused_with_the_error_at_the_far_side) {
  const Points a{{0, 0, 500}, {14, 3, 500}, {5, 12, 501}};

  const Matched found = match(a, a);

  EXPECT_EQ(found.report.state, MatchState::kClustered);
  EXPECT_GT(found.report.error_at_reach_mm, 0.2);
  EXPECT_TRUE(found.pairs.empty());
}

TEST(MarkerMatcher, two_markers_none_and_strangers_are_too_few) {
  Pcg32 random(8);
  const Points two{{0, 0, 500}, {50, 0, 500}};

  EXPECT_EQ(match(two, two).report.state, MatchState::kTooFew);
  EXPECT_EQ(match({}, {}).report.state, MatchState::kTooFew);
  const MatchState strangers = match(field(8, random), field(8, random)).report.state;
  EXPECT_NE(strangers, MatchState::kMatched);
}

TEST(MarkerMatcher, what_is_not_finite_matches_nothing) {
  Pcg32 random(9);
  const Points a = field(10, random);
  Points b = a;
  b[3].setConstant(std::numeric_limits<double>::quiet_NaN());
  b[7].x() = std::numeric_limits<double>::infinity();

  const Matched found = match(a, b);

  EXPECT_EQ(found.report.state, MatchState::kMatched);
  EXPECT_EQ(found.report.num_pairs, 8U);
}

}  // namespace
}  // namespace dseam::markers
