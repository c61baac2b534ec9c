// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/radius_outlier_removal.hpp"

#include <algorithm>

#include "dseam/search/query_cell.hpp"

namespace dseam::cloud {
namespace {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;
using lanes::splat;
using search::Cell;

constexpr std::uint32_t kMostNeighbours = 1U << 20U;
constexpr std::uint32_t kAll = 0xFFU;

}  // namespace

Result<RadiusOutlierRemoval> RadiusOutlierRemoval::make(const Config& config,
                                                        std::size_t max_points,
                                                        Arena& arena) noexcept {
  const bool sensible = config.radius_mm > 0.0F && config.radius_mm <= search::GridIndex::kMaxMm;
  if (!sensible || config.min_neighbours > kMostNeighbours) {
    return Errc::kInvalidArgument;
  }
  RadiusOutlierRemoval stage(config, arena.take<std::uint8_t>(max_points));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

void RadiusOutlierRemoval::judge_cell(const search::CellTree& tree, std::uint32_t at) noexcept {
  const Cell& own = tree.cells()[at];
  const search::QueryCell query(own);
  const FloatLanes squared_radius = splat(config_.radius_mm * config_.radius_mm);
  // A point finds itself too.
  const IntLanes enough = splat(static_cast<std::int32_t>(config_.min_neighbours));
  IntLanes count = splat(-1);
  const auto is_done = [&]() noexcept { return lanes::bits(count < enough) == 0; };
  const auto reach = [&]() noexcept {
    return search::Reach{is_done() ? -1.0F : squared_radius[0]};  // Nothing is nearer than -1.
  };
  tree.visit_around(at, tree.box_of(at), reach, [&](std::uint32_t other) noexcept {
    const Cell& cell = tree.cells()[other];
    for (std::size_t i = 0; i < kLanes && !is_done(); ++i) {
      count = count - (query.squared_distances(cell, i) <= squared_radius);
    }
  });
  const std::uint32_t kept = kAll & ~lanes::bits(count < enough);
  for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
    keep_[own.index[i]] = (kept >> i) & 1U;
  }
}

RadiusOutlierRemoval::Report RadiusOutlierRemoval::run(const search::GridIndex& index,
                                                       std::size_t num_points,
                                                       Buffer<std::uint32_t>& kept) noexcept {
  DSEAM_EXPECTS(num_points <= keep_.size());
  kept.clear();
  std::fill_n(keep_.begin(), num_points, std::uint8_t{0});
  for (std::uint32_t at = 0; at < index.tree().cells().size(); ++at) {
    judge_cell(index.tree(), at);
  }
  Report report;
  for (std::uint32_t i = 0; i < num_points; ++i) {
    report.removed += keep_[i] != 0 ? 0U : 1U;
    report.dropped_full += keep_[i] != 0 && !kept.append(i) ? 1U : 0U;
  }
  report.kept = static_cast<std::uint32_t>(kept.size());
  return report;
}

}  // namespace dseam::cloud
