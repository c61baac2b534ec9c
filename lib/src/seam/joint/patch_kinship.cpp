// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/patch_kinship.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace dseam::seam {
namespace {

constexpr double kMaxCorrelation = 0.8;
constexpr double kMaxTaken = 0.5;
constexpr int kRounds = 3;
constexpr int kLags = 4;

// Of all patches with the next one round the joint.
double next_correlation(std::span<const Patch> patches, std::span<const float> rests,
                        std::size_t round) noexcept {
  std::array<std::uint16_t, kMaxPatches> at{};  // Plus one; 0: no patch.
  for (std::size_t i = 0; i < patches.size(); ++i) {
    at[patches[i].place] = static_cast<std::uint16_t>(i + 1);
  }
  double products = 0.0;
  double squares = 1e-15;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const std::size_t column = patches[i].place % round;
    const std::size_t other = at[patches[i].place - column + (column + 1) % round];
    if (other != 0) {
      const double weight = std::sqrt(patches[i].weight * patches[other - 1].weight);
      const double a = rests[i];
      const double b = rests[other - 1];
      products += weight * a * b;
      squares += 0.5 * weight * (a * a + b * b);
    }
  }
  return products / squares;
}

// One plus twice the correlations at all lags, of steps so many times as long as the measured one.
double sum_of_correlations(double next, double steps) noexcept {
  double sum = 1.0;
  for (int lag = 1; lag <= kLags; ++lag) {
    sum += 2.0 * std::pow(next, steps * steps * lag * lag);
  }
  return sum;
}

}  // namespace

double patches_in_one(std::span<const Patch> patches, std::span<const float> rests,
                      const PatchGrid& grid, std::size_t num_columns) noexcept {
  const double of_rests = next_correlation(patches, rests, grid.round);
  const double share = static_cast<double>(num_columns) / static_cast<double>(patches.size() + 1);
  double in_one = 1.0;
  for (int i = 0; i < kRounds; ++i) {
    const double taken = std::min(share * in_one, kMaxTaken);
    const double next = std::clamp(of_rests * (1.0 - taken) + taken, 0.0, kMaxCorrelation);
    in_one = sum_of_correlations(next, 1.0) *
             sum_of_correlations(next, grid.step_away_mm / grid.step_round_mm);
  }
  return in_one;
}

}  // namespace dseam::seam
