// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/patch_kinship.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dseam/base/random.hpp"
#include "support/gaussian.hpp"

namespace dseam::seam {
namespace {

constexpr int kRound = 40;
constexpr double kStepRoundMm = 8.0;
constexpr double kStepAwayMm = 6.0;

struct Field {
  std::vector<Patch> patches;
  std::vector<float> rests;
};

// Noise that falls off as exp(-(d / L)^2): a sum of bumps of white noise, exp(-2 (d / L)^2) each.
Field field_of(double length_mm, std::uint64_t seed) {
  constexpr double kGridMm = 2.0;
  constexpr int kGridsRound = 4;
  constexpr int kGridsAway = 3;
  constexpr int kReach = 8;
  Pcg32 random(seed);
  const int columns = kRound * kGridsRound;
  const int rows = int{kPatchesAway} * kGridsAway + 2 * kReach;
  std::vector<double> white(static_cast<std::size_t>(columns * rows));
  std::ranges::generate(white, [&] { return test::gaussian(random); });
  Field field;
  for (int place = 0; place < kRound * int{kPatchesAway}; ++place) {
    const int u = place % kRound * kGridsRound;
    const int v = place / kRound * kGridsAway + kReach;
    double sum = 0.0;
    for (int dv = -kReach; dv <= kReach; ++dv) {
      for (int du = -kReach; du <= kReach; ++du) {
        const double d_mm = kGridMm * std::hypot(du, dv);
        const int at = (v + dv) * columns + (u + du + columns) % columns;
        sum += std::exp(-2.0 * d_mm * d_mm / (length_mm * length_mm)) *
               white[static_cast<std::size_t>(at)];
      }
    }
    Patch patch;
    patch.weight = 1.0;
    patch.place = static_cast<std::size_t>(place);
    field.patches.push_back(patch);
    field.rests.push_back(static_cast<float>(sum));
  }
  return field;
}

// One plus all correlations with others, as a mean of many patches counts them.
double true_patches_in_one(double length_mm) {
  double sum = 0.0;
  for (int i = -6; i <= 6; ++i) {
    for (int k = -6; k <= 6; ++k) {
      const double d_mm = std::hypot(i * kStepRoundMm, k * kStepAwayMm);
      sum += std::exp(-d_mm * d_mm / (length_mm * length_mm));
    }
  }
  return sum;
}

struct Spread {
  double mean = 0.0;
  double least = 1e9;
  double most = 0.0;
};

Spread patches_in_one_of(double length_mm) {
  constexpr int kSeeds = 40;
  Spread spread;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Field field = field_of(length_mm, seed);
    const double found = patches_in_one(
        field.patches, field.rests, {kRound, kStepRoundMm, kStepAwayMm}, 0, Neighbours::kAllAround);
    spread.mean += found / kSeeds;
    spread.least = std::min(spread.least, found);
    spread.most = std::max(spread.most, found);
  }
  return spread;
}

TEST(PatchKinship, of_white_noise_is_none) {
  const Spread found = patches_in_one_of(1.5);

  EXPECT_GE(found.least, 1.0);
  EXPECT_LT(found.mean, 1.3);
}

TEST(PatchKinship, is_that_of_noise_that_hangs_together_over_a_patch) {
  const Spread found = patches_in_one_of(8.0);

  EXPECT_NEAR(found.mean, true_patches_in_one(8.0), 0.15 * true_patches_in_one(8.0));
  EXPECT_GT(found.least, 0.5 * true_patches_in_one(8.0));
  EXPECT_LT(found.most, 1.8 * true_patches_in_one(8.0));
}

TEST(PatchKinship, puts_back_what_the_fit_took_out) {
  const Field field = field_of(8.0, 1);
  const PatchGrid grid{kRound, kStepRoundMm, kStepAwayMm};

  for (const Neighbours neighbours : {Neighbours::kRound, Neighbours::kAllAround}) {
    EXPECT_GT(patches_in_one(field.patches, field.rests, grid, 17, neighbours),
              patches_in_one(field.patches, field.rests, grid, 0, neighbours));
  }
}

}  // namespace
}  // namespace dseam::seam
