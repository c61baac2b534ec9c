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

std::size_t next_round(std::size_t place, std::size_t round) noexcept {
  const std::size_t column = place % round;
  return place - column + (column + 1) % round;
}

// Of neighbouring patches, weighted by what both saw.
class Correlation {
 public:
  void add(const Patch& a, const Patch& b, double rest_a, double rest_b) noexcept {
    const double weight = std::sqrt(a.weight * b.weight);
    products_ += weight * rest_a * rest_b;
    squares_ += 0.5 * weight * (rest_a * rest_a + rest_b * rest_b);
  }
  [[nodiscard]] double value() const noexcept { return products_ / squares_; }

 private:
  double products_ = 0.0;
  double squares_ = 1e-15;
};

double next_correlation(std::span<const Patch> patches, std::span<const float> rests,
                        std::size_t round, Neighbours neighbours) noexcept {
  std::array<std::uint16_t, 2 * kMaxPatches> at{};  // Plus one; 0: no patch.
  for (std::size_t i = 0; i < patches.size(); ++i) {
    at[patches[i].place] = static_cast<std::uint16_t>(i + 1);
  }
  Correlation found;
  const auto compare = [&](std::size_t i, std::size_t place) {
    if (const std::size_t other = at[place]; other != 0) {
      found.add(patches[i], patches[other - 1], rests[i], rests[other - 1]);
    }
  };
  for (std::size_t i = 0; i < patches.size(); ++i) {
    compare(i, next_round(patches[i].place, round));
    if (neighbours == Neighbours::kAllAround) {
      compare(i, patches[i].place + round);
    }
  }
  return found.value();
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
                      const PatchGrid& grid, std::size_t num_columns,
                      Neighbours neighbours) noexcept {
  const double of_rests = next_correlation(patches, rests, grid.round, neighbours);
  const double share = static_cast<double>(num_columns) / static_cast<double>(patches.size() + 1);
  const double step_mm = neighbours == Neighbours::kRound
                             ? grid.step_round_mm
                             : 0.5 * (grid.step_round_mm + grid.step_away_mm);
  double in_one = 1.0;
  for (int i = 0; i < kRounds; ++i) {
    const double taken = std::min(share * in_one, kMaxTaken);
    const double next = std::clamp(of_rests * (1.0 - taken) + taken, 0.0, kMaxCorrelation);
    in_one = sum_of_correlations(next, grid.step_round_mm / step_mm) *
             sum_of_correlations(next, grid.step_away_mm / step_mm);
  }
  return in_one;
}

}  // namespace dseam::seam
