// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/outlier_removal.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::cloud {
namespace {

constexpr float kLeftOut = -1.0F;

struct Spread {
  double mean = 0.0;
  double sigma = 0.0;
};

// Two passes: the sum of squares alone would lose the spread of far-away means.
Spread spread_of(std::span<const float> values, std::size_t count) noexcept {
  Spread spread;
  for (const float value : values) {
    spread.mean += value == kLeftOut ? 0.0 : static_cast<double>(value);
  }
  spread.mean /= static_cast<double>(count);
  double squares = 0.0;
  for (const float value : values) {
    const double off = static_cast<double>(value) - spread.mean;
    squares += value == kLeftOut ? 0.0 : off * off;
  }
  spread.sigma = std::sqrt(squares / static_cast<double>(count));
  return spread;
}

}  // namespace

Result<OutlierRemoval> OutlierRemoval::make(const Config& config, std::size_t max_points,
                                            Arena& arena) noexcept {
  const bool sensible = config.num_neighbours >= 1 &&
                        config.num_neighbours <= search::GridIndex::kMaxBatchNeighbours &&
                        std::isfinite(config.alpha);
  if (!sensible) {
    return Errc::kInvalidArgument;
  }
  OutlierRemoval stage(config, arena.take<float>(max_points));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

OutlierRemoval::Report OutlierRemoval::run(const search::GridIndex& index, std::size_t num_points,
                                           Buffer<std::uint32_t>& kept) noexcept {
  DSEAM_EXPECTS(num_points <= mean_mm_.size());
  kept.clear();
  Report report;
  report.too_few_points = index.size() <= config_.num_neighbours;
  if (index.size() == 0) {
    report.removed = static_cast<std::uint32_t>(num_points);
    return report;
  }
  const std::span<float> means = mean_mm_.first(num_points);
  std::fill(means.begin(), means.end(), kLeftOut);
  index.mean_distances(config_.num_neighbours, means);
  const Spread spread = spread_of(means, index.size());
  const double threshold = spread.mean + static_cast<double>(config_.alpha) * spread.sigma;
  report.mean_mm = static_cast<float>(spread.mean);
  report.sigma_mm = static_cast<float>(spread.sigma);
  report.threshold_mm = static_cast<float>(threshold);
  for (std::uint32_t i = 0; i < num_points; ++i) {
    const bool keep = means[i] != kLeftOut && static_cast<double>(means[i]) <= threshold;
    report.removed += keep ? 0U : 1U;
    report.dropped_full += keep && !kept.append(i) ? 1U : 0U;
  }
  report.kept = static_cast<std::uint32_t>(kept.size());
  return report;
}

}  // namespace dseam::cloud
