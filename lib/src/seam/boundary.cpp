// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/boundary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "dseam/base/expects.hpp"
#include "dseam/search/query_cell.hpp"
#include "turn.hpp"

namespace dseam::seam {
namespace {

using geometry::Vec3f;
using lanes::FloatLanes;
using lanes::kLanes;
using lanes::splat;
using search::Cell;

constexpr float kSectorsPerRad = static_cast<float>(BoundaryTest::kSectors) / kFullTurn;
constexpr float kLastSector = static_cast<float>(BoundaryTest::kSectors - 1);

// A neighbour straight along the normal, or in the same place, has no direction but rounding's.
constexpr float kSquaredSteepness = 1.0e-8F;

bool is_positive(float value) noexcept { return value > 0.0F && std::isfinite(value); }

Vec3f point_of(const Cell& cell, std::size_t lane) noexcept {
  return {cell.x[lane], cell.y[lane], cell.z[lane]};
}

/// Where the surface is open.
struct Gap {
  float size_rad;
  float middle_rad;
};

// The largest gap between one neighbour's angle and the next.
Gap largest_gap(std::uint64_t hit, const float* least, const float* greatest) noexcept {
  if (hit == 0) {
    return {kFullTurn, 0.0F};
  }
  const auto last = static_cast<std::size_t>(63 - std::countl_zero(hit));
  float from = greatest[last] - kFullTurn;
  Gap gap{0.0F, 0.0F};
  for (; hit != 0; hit &= hit - 1) {
    const auto sector = static_cast<std::size_t>(std::countr_zero(hit));
    const float size = least[sector] - from;
    if (size > gap.size_rad) {
      gap = {size, from + 0.5F * size};
    }
    from = greatest[sector];
  }
  return gap;
}

}  // namespace

Result<BoundaryTest> BoundaryTest::make(const Config& config, Arena& arena) noexcept {
  if (!is_positive(config.radius_mm) || !is_positive(config.min_gap_rad)) {
    return Errc::kInvalidArgument;
  }
  BoundaryTest stage(config, arena.take<Sectors>(kLanes));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

void BoundaryTest::Sectors::start(Vec3f its_point, Vec3f normal) noexcept {
  hit = 0;
  count = 0;
  point = its_point;
  // Without the smaller of x and y the vector across cannot vanish.
  const Vec3f across = std::fabs(normal.x) < std::fabs(normal.y) ? Vec3f{0.0F, normal.z, -normal.y}
                                                                 : Vec3f{-normal.z, 0.0F, normal.x};
  v = across * (1.0F / geometry::norm(across));
  u = geometry::cross(normal, v);
}

void BoundaryTest::Sectors::add(const Cell& cell, float squared_radius) noexcept {
  const FloatLanes dx = lanes::load(cell.x) - splat(point.x);
  const FloatLanes dy = lanes::load(cell.y) - splat(point.y);
  const FloatLanes dz = lanes::load(cell.z) - splat(point.z);
  const FloatLanes squared = dx * dx + dy * dy + dz * dz;
  const lanes::IntLanes near = squared <= splat(squared_radius);
  const FloatLanes a = dx * splat(u.x) + dy * splat(u.y) + dz * splat(u.z);
  const FloatLanes b = dx * splat(v.x) + dy * splat(v.y) + dz * splat(v.z);
  const FloatLanes sum = lanes::magnitude(a) + lanes::magnitude(b);
  const lanes::IntLanes has_angle = near & (squared * splat(kSquaredSteepness) < sum * sum);
  const FloatLanes turn = lanes::keep(has_angle, turn_of(a, b, sum));
  alignas(32) float turns[kLanes];
  alignas(32) std::int32_t sectors[kLanes];
  store(turn, turns);
  store(lanes::to_int(lanes::min(turn * splat(kSectorsPerRad), splat(kLastSector))), sectors);
  count += static_cast<std::uint32_t>(std::popcount(lanes::bits(near)));
  for (std::uint32_t left = lanes::bits(has_angle); left != 0; left &= left - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(left));
    const auto sector = static_cast<std::size_t>(sectors[lane]);
    const bool is_new = (hit >> sector & 1U) == 0;
    least[sector] = is_new ? turns[lane] : std::min(least[sector], turns[lane]);
    greatest[sector] = is_new ? turns[lane] : std::max(greatest[sector], turns[lane]);
    hit |= std::uint64_t{1} << sector;
  }
}

void BoundaryTest::collect(const search::CellTree& tree, std::uint32_t at,
                           const cloud::NormalsView& normals) noexcept {
  const Cell& own = tree.cells()[at];
  std::uint32_t with_normal = 0;
  for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
    const std::size_t index = own.index[i];
    const Vec3f normal{normals.nx[index], normals.ny[index], normals.nz[index]};
    with_normal |= (normal == Vec3f{} ? 0U : 1U) << i;
    sectors_[i].start(point_of(own, i), normal);
  }
  const search::QueryCell query(own);
  const float squared_radius = config_.radius_mm * config_.radius_mm;
  const FloatLanes limit = splat(squared_radius);
  const auto reach = [squared_radius]() noexcept { return search::Reach{squared_radius}; };
  tree.visit_around(at, tree.box_of(at), reach, [&](std::uint32_t other) noexcept {
    std::uint32_t near = query.bits_within(tree.box_of(other), limit) & with_normal;
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(near));
      sectors_[i].add(tree.cells()[other], squared_radius);
    }
  });
}

void BoundaryTest::judge(std::size_t index, Vec3f normal, const Sectors& sectors,
                         BoundaryBuffer& out, Report& report) const noexcept {
  const bool has_normal = normal != Vec3f{};
  const bool enough = sectors.count > config_.min_neighbours;  // A point finds itself too.
  const Gap gap = has_normal && enough ? largest_gap(sectors.hit, sectors.least, sectors.greatest)
                                       : Gap{0.0F, 0.0F};
  Vec3f open;
  if (gap.size_rad > 0.0F) {
    const CosineSine middle =
        cosine_sine(gap.middle_rad < 0.0F ? gap.middle_rad + kFullTurn : gap.middle_rad);
    open = sectors.u * middle.cosine + sectors.v * middle.sine;
  }
  out.gap_rad[index] = gap.size_rad;
  out.open_x[index] = open.x;
  out.open_y[index] = open.y;
  out.open_z[index] = open.z;
  report.without_normal += has_normal ? 0U : 1U;
  report.too_few += has_normal && !enough ? 1U : 0U;
  report.inner += has_normal && enough && !(gap.size_rad > config_.min_gap_rad) ? 1U : 0U;
}

BoundaryTest::Report BoundaryTest::run(const search::GridIndex& index,
                                       const cloud::NormalsView& normals, BoundaryBuffer& out,
                                       Buffer<std::uint32_t>& found) noexcept {
  const std::size_t num_points = normals.nx.size();
  DSEAM_EXPECTS(num_points <= out.open_z.size());
  Report report;
  report.without_normal = static_cast<std::uint32_t>(num_points - index.size());
  std::fill_n(out.gap_rad.begin(), num_points, 0.0F);
  const search::CellTree& tree = index.tree();
  for (std::uint32_t at = 0; at < tree.cells().size(); ++at) {
    collect(tree, at, normals);
    const Cell& own = tree.cells()[at];
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      const std::size_t point = own.index[i];
      judge(point, {normals.nx[point], normals.ny[point], normals.nz[point]}, sectors_[i], out,
            report);
    }
  }
  found.clear();
  for (std::uint32_t i = 0; i < num_points; ++i) {
    const bool open = out.gap_rad[i] > config_.min_gap_rad;
    report.dropped_full += open && !found.append(i) ? 1U : 0U;
    report.boundary += open ? 1U : 0U;
  }
  return report;
}

}  // namespace dseam::seam
