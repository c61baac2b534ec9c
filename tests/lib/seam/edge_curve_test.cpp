// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/edge/edge_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "support/allocation_counter.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;

double round_hole(double /*phi_rad*/) { return 2.0; }
double shifted_hole(double phi_rad) { return 1.5 + 0.7 * std::cos(phi_rad - 0.4); }
double oval_hole(double phi_rad) { return 2.0 + 0.3 * std::cos(2.0 * phi_rad + 0.7); }
double squarish_hole(double phi_rad) { return 2.0 + 0.2 * std::cos(4.0 * phi_rad + 1.0); }

/// Pixels of 0.3 mm at random places about the edge; some ends are dropped, so the interval widens.
std::vector<EdgeInterval> intervals_of(double (*edge)(double), double wrong_share,
                                       std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<EdgeInterval> intervals;
  for (int i = 0; i < 1200; ++i) {
    const double phi = kTurnRad * uniform(random);
    const double low = edge(phi) - 0.3 * uniform(random);
    EdgeInterval interval{phi, low, low + 0.3};
    interval.low_mm -= uniform(random) < 0.3 ? 0.3 : 0.0;
    if (uniform(random) < wrong_share) {  // A pixel of the shell was taken for one behind it.
      interval.low_mm += 0.3;
      interval.high_mm += 0.3;
    }
    intervals.push_back(interval);
  }
  return intervals;
}

struct Deviation {
  double mean_mm = 0.0;
  double max_mm = 0.0;
};

Deviation deviation(const EdgeCurve& curve, double (*edge)(double)) {
  Deviation d;
  for (int i = 0; i < 360; ++i) {
    const double phi = kTurnRad * i / 360.0;
    const double off = curve.at(phi) - edge(phi);
    d.mean_mm += off / 360.0;
    d.max_mm = std::max(d.max_mm, std::abs(off));
  }
  return d;
}

TEST(EdgeCurve, follows_round_shifted_oval_and_squarish_holes) {
  for (double (*edge)(double) : {round_hole, shifted_hole, oval_hole, squarish_hole}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const auto intervals = intervals_of(edge, 0.0, seed);
      EdgeCurve curve;

      ASSERT_TRUE(curve.fit(intervals));

      EXPECT_LT(deviation(curve, edge).max_mm, 0.02);
    }
  }
}

// The pixels on both sides of the edge hang between the two depths, a few by chance at the shell's.
TEST(EdgeCurve, runs_amid_intervals_that_all_end_a_pixel_away_and_says_how_free_it_is) {
  constexpr double kPixelMm = 0.4;
  std::vector<EdgeInterval> intervals = intervals_of(shifted_hole, 0.01, 3);
  for (EdgeInterval& interval : intervals) {
    interval.low_mm -= kPixelMm;
    interval.high_mm += kPixelMm;
  }
  EdgeCurve curve;

  ASSERT_TRUE(curve.fit(intervals));

  EXPECT_LT(deviation(curve, shifted_hole).max_mm, 0.25 * kPixelMm);
  EXPECT_NEAR(std::sqrt(curve.variance_at(1.0)), 2.0 * kPixelMm / std::sqrt(12.0), 0.1 * kPixelMm);
}

TEST(EdgeCurve, is_as_uncertain_as_intervals_are_wide_that_contradict_each_other) {
  std::vector<EdgeInterval> intervals = intervals_of(round_hole, 0.0, 3);
  double width_mm = 0.0;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    EdgeInterval& interval = intervals[i];
    interval.low_mm +=
        i % 4 == 0 ? 0.6 : 0.0;  // A flying pixel of the shell passed for one past it.
    interval.high_mm = std::max(interval.high_mm, interval.low_mm + 0.3);
    width_mm += (interval.high_mm - interval.low_mm) / static_cast<double>(intervals.size());
  }
  EdgeCurve curve;

  ASSERT_TRUE(curve.fit(intervals));

  EXPECT_GT(std::sqrt(curve.variance_at(1.0)), 0.9 * width_mm / std::sqrt(12.0));
}

// Holes ever more oval, until the curve takes it in: what it left out before is what it says.
TEST(EdgeCurve, knows_how_oval_a_hole_may_be_that_it_takes_for_round) {
  double most_mm = 0.0;
  double said_mm2 = 0.0;
  for (double oval_mm = 0.0; oval_mm < 0.05; oval_mm += 0.001) {
    std::vector<EdgeInterval> intervals = intervals_of(round_hole, 0.0, 7);
    for (EdgeInterval& interval : intervals) {
      interval.low_mm += oval_mm * std::cos(2.0 * interval.phi_rad);
      interval.high_mm += oval_mm * std::cos(2.0 * interval.phi_rad);
    }
    EdgeCurve curve;
    ASSERT_TRUE(curve.fit(intervals));
    if (curve.order() > 1) {
      break;
    }
    most_mm = oval_mm;
    said_mm2 = curve.unnoticed_variance_at(0.0);
  }

  // Mean over all sizes that may hide and over the angle: a quarter of the largest one's square.
  EXPECT_GT(most_mm, 0.0);
  EXPECT_NEAR(std::sqrt(said_mm2), 0.5 * most_mm, 0.25 * most_mm);
}

TEST(EdgeCurve, does_not_bend_for_noise) {
  const auto intervals = intervals_of(round_hole, 0.0, 5);
  EdgeCurve curve;

  ASSERT_TRUE(curve.fit(intervals));

  EXPECT_EQ(curve.harmonics(), 0U);
}

TEST(EdgeCurve, wrong_intervals_on_one_side_leave_no_bias) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto intervals = intervals_of(oval_hole, 0.05, seed);
    EdgeCurve curve;

    ASSERT_TRUE(curve.fit(intervals));

    EXPECT_LT(std::abs(deviation(curve, oval_hole).mean_mm), 0.01);
    EXPECT_LT(deviation(curve, oval_hole).max_mm, 0.04);
  }
}

TEST(EdgeCurve, its_error_is_as_large_as_it_predicts) {
  int inside = 0;
  constexpr int kScans = 100;
  for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
    const auto intervals = intervals_of(oval_hole, 0.02, seed);
    EdgeCurve curve;

    ASSERT_TRUE(curve.fit(intervals));

    const double off = curve.at(1.0) - oval_hole(1.0);
    inside += off * off < 3.841 * curve.variance_at(1.0) ? 1 : 0;
  }
  EXPECT_GE(inside, 86);
}

TEST(EdgeCurve, too_few_intervals_and_a_third_of_the_turn_unseen_are_no_edge) {
  const auto intervals = intervals_of(round_hole, 0.0, 1);
  const std::span<const EdgeInterval> few = std::span(intervals).first(30);
  auto arc = intervals;
  std::erase_if(arc, [](const EdgeInterval& i) { return i.phi_rad > 0.66 * kTurnRad; });
  EdgeCurve curve;

  EXPECT_FALSE(curve.fit(few));
  EXPECT_FALSE(curve.fit(arc));
}

TEST(EdgeCurve, does_not_swing_where_nothing_holds_it) {
  auto intervals = intervals_of(squarish_hole, 0.02, 2);
  std::erase_if(intervals, [](const EdgeInterval& i) { return i.phi_rad > 0.5 * kTurnRad; });
  intervals.resize(45);
  EdgeCurve curve;

  const bool fitted = curve.fit(intervals);

  EXPECT_TRUE(!fitted || deviation(curve, squarish_hole).max_mm < 1.0);
}

TEST(EdgeCurve, an_edge_anywhere_in_wide_intervals_is_as_uncertain_as_they_are_wide) {
  std::vector<EdgeInterval> intervals;
  for (int i = 0; i < 400; ++i) {
    intervals.push_back({kTurnRad * i / 400.0, 2.0, 4.0});  // A dead band of 2 mm beside the edge.
  }
  EdgeCurve curve;

  ASSERT_TRUE(curve.fit(intervals));

  EXPECT_NEAR(std::sqrt(curve.variance_at(1.0)), 2.0 / std::sqrt(12.0), 0.1);
}

TEST(EdgeCurve, what_it_only_bridges_is_not_held_and_uncertain) {
  auto intervals = intervals_of(oval_hole, 0.0, 1);
  std::erase_if(intervals, [](const EdgeInterval& i) { return std::abs(i.phi_rad - 2.0) < 0.6; });
  EdgeCurve curve;

  ASSERT_TRUE(curve.fit(intervals));

  EXPECT_FALSE(curve.held_at(2.0));
  EXPECT_TRUE(curve.held_at(4.0));
  EXPECT_GT(curve.variance_at(2.0), 10.0 * curve.variance_at(4.0));
}

TEST(EdgeCurve, fitting_does_not_allocate) {
  const auto intervals = intervals_of(oval_hole, 0.0, 1);
  EdgeCurve curve;
  const test::AllocationCounter allocations;

  (void)curve.fit(intervals);

  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace dseam::seam
