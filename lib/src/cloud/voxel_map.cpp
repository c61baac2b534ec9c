// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/voxel_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dseam/base/expects.hpp"

namespace dseam::cloud {
namespace {

using lanes::kLanes;
using search::CellKey;
using search::VoxelHash;

// The axes of a cell go through the same arithmetic side by side; the fourth place is idle. They
// are never returned: how 32 bytes come back from a function depends on the processor's extensions.
typedef double Axes __attribute__((vector_size(32)));
typedef std::uint64_t AxisWords __attribute__((vector_size(32)));

// Of whole numbers under 2^52, as those in the low bits of 2^52: exact, and no processor lacks it.
[[gnu::always_inline]] inline void to_doubles(const AxisWords& whole, Axes& out) noexcept {
  constexpr double kBase = 4503599627370496.0;
  out = reinterpret_cast<Axes>(whole | std::bit_cast<std::uint64_t>(kBase)) - kBase;
}

[[gnu::always_inline]] inline void cells_of(CellKey key, Axes& out) noexcept {
  constexpr AxisWords kShifts = {0, CellKey::kAxisBits, 2 * CellKey::kAxisBits, 0};
  const AxisWords keys = {key.bits, key.bits, key.bits, 0};
  to_doubles((keys >> kShifts) & ((std::uint64_t{1} << CellKey::kAxisBits) - 1), out);
}

bool is_finite(geometry::Vec3f p) noexcept {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool is_sensible(float cell_mm) noexcept { return cell_mm >= 1.0e-3F && cell_mm <= 1.0e6F; }

}  // namespace

Result<VoxelMap> VoxelMap::make(const Config& config, std::size_t max_cells,
                                Arena& arena) noexcept {
  if (!is_sensible(config.cell_mm) || !is_finite(config.origin_mm)) {
    return Errc::kInvalidArgument;
  }
  const auto hash = VoxelHash::make(max_cells, arena, config.secret);
  if (!hash.ok()) {
    return hash.error();
  }
  VoxelMap map(config, hash.value(), max_cells, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return map;
}

VoxelMap::VoxelMap(const Config& config, const VoxelHash& hash, std::size_t max_cells,
                   Arena& arena) noexcept
    : config_(config),
      cells_per_mm_(1.0F / config.cell_mm),
      hash_(hash),
      runs_(arena.take<CellRuns>(1)),
      sums_(arena.take<Sum>(max_cells)),
      centroids_(max_cells, arena),
      count_(arena.take<std::uint32_t>(max_cells)),
      seen_by_(arena.take<ViewMask>(max_cells)) {}

void VoxelMap::clear() noexcept {
  hash_.clear();
  runs_[0].clear();
}

void VoxelMap::relay(float cell_mm, geometry::Vec3f origin_mm) noexcept {
  DSEAM_EXPECTS(is_sensible(cell_mm) && is_finite(origin_mm));
  config_.cell_mm = cell_mm;
  config_.origin_mm = origin_mm;
  cells_per_mm_ = 1.0F / cell_mm;
  clear();
}

VoxelMap::Report VoxelMap::insert(const CloudView& cloud, std::size_t view) noexcept {
  DSEAM_EXPECTS(view < kMaxViews);
  const auto seen_by = static_cast<ViewMask>(1U << view);
  const std::size_t whole = cloud.size() / kLanes * kLanes;
  Report report;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    insert_eight(lanes::load(&cloud.x[i]), lanes::load(&cloud.y[i]), lanes::load(&cloud.z[i]),
                 0xFFU, seen_by, report);
  }
  if (const std::size_t rest = cloud.size() - whole; rest > 0) {
    float x[kLanes] = {};
    float y[kLanes] = {};
    float z[kLanes] = {};
    std::copy_n(&cloud.x[whole], rest, x);
    std::copy_n(&cloud.y[whole], rest, y);
    std::copy_n(&cloud.z[whole], rest, z);
    insert_eight(lanes::load(x), lanes::load(y), lanes::load(z), (1U << rest) - 1U, seen_by,
                 report);
  }
  flush(seen_by, report);
  return report;
}

// A new cell's slot lies anywhere in memory. It is asked for kAhead runs before it is needed: the
// memory answers while others are summed, and no more wait at a time than it answers at once.
void VoxelMap::flush(ViewMask seen_by, Report& report) noexcept {
  constexpr std::size_t kAhead = 32;
  CellRuns& runs = runs_[0];
  const std::size_t count = runs.cut();
  const auto ask_for = [&](std::size_t run) noexcept {
    const CellKey key = runs.key(run);
    runs.wanted[run] = {key, hash_.place_of(key)};
    hash_.fetch(runs.wanted[run].place);
  };
  for (std::size_t i = 0; i < std::min(kAhead, count); ++i) {
    ask_for(i);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (i + kAhead < count) {
      ask_for(i + kAhead);
    }
    const std::size_t known = hash_.size();
    const std::uint32_t number = hash_.find_or_insert(runs.wanted[i].key, runs.wanted[i].place);
    if (number == VoxelHash::kFull) {
      report.dropped_full += runs.count(i);
      continue;
    }
    Sum& sum = sums_[number];
    if (number == known) {
      sum = Sum{};
    }
    sum.x += runs.x(i);
    sum.y += runs.y(i);
    sum.z += runs.z(i);
    sum.count += runs.count(i);
    sum.seen_by |= seen_by;
    report.inserted += runs.count(i);
  }
  runs.clear();
}

FusedCloudView VoxelMap::view() noexcept {
  const double step_mm = static_cast<double>(config_.cell_mm) / static_cast<double>(kStepsPerCell);
  const geometry::Vec3f& origin = config_.origin_mm;
  const Axes origin_mm = {static_cast<double>(origin.x), static_cast<double>(origin.y),
                          static_cast<double>(origin.z), 0.0};
  centroids_.resize(size());
  for (std::size_t i = 0; i < size(); ++i) {
    const Sum& sum = sums_[i];
    Axes cell;
    Axes steps;
    cells_of(hash_.keys()[i], cell);
    to_doubles(AxisWords{sum.x, sum.y, sum.z, 0}, steps);
    cell -= static_cast<double>(kMaxAxis);
    const Axes inside_mm = steps / static_cast<double>(sum.count) * step_mm;
    const Axes mm = origin_mm + cell * static_cast<double>(config_.cell_mm) + inside_mm;
    centroids_.set(
        i, {static_cast<float>(mm[0]), static_cast<float>(mm[1]), static_cast<float>(mm[2])});
    count_[i] = sum.count;
    seen_by_[i] = sum.seen_by;
  }
  return {centroids_.view(), count_.first(size()), seen_by_.first(size())};
}

std::uint32_t VoxelMap::find(geometry::Vec3f point) const noexcept {
  const float x = (point.x - config_.origin_mm.x) * cells_per_mm_;
  const float y = (point.y - config_.origin_mm.y) * cells_per_mm_;
  const float z = (point.z - config_.origin_mm.z) * cells_per_mm_;
  if (!(std::fabs(x) < kMaxAxis && std::fabs(y) < kMaxAxis && std::fabs(z) < kMaxAxis)) {
    return VoxelHash::kAbsent;
  }
  return hash_.find(CellKey::of(static_cast<std::int32_t>(std::floor(x)),
                                static_cast<std::int32_t>(std::floor(y)),
                                static_cast<std::int32_t>(std::floor(z))));
}

}  // namespace dseam::cloud
