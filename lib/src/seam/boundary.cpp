// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/boundary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "../geometry/vec3_lanes.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/base/lane_packer.hpp"
#include "turn.hpp"

namespace dseam::seam {
namespace {

using geometry::Vec3f;
using geometry::Vec3Lanes;
using lanes::FloatLanes;
using lanes::kLanes;
using lanes::splat;
using search::Cell;

constexpr float kSectorsPerRad = static_cast<float>(BoundaryTest::kSectors) / kFullTurn;
constexpr float kLastSector = static_cast<float>(BoundaryTest::kSectors - 1);

// A neighbour straight along the normal, or in the same place, has no direction but rounding's.
constexpr float kSquaredSteepness = 1.0e-8F;

bool is_positive(float value) noexcept { return value > 0.0F && std::isfinite(value); }

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
  float size_rad = 0.0F;
  float start_rad = 0.0F;
  for (; hit != 0; hit &= hit - 1) {
    const auto sector = static_cast<std::size_t>(std::countr_zero(hit));
    const float size = least[sector] - from;
    start_rad = size > size_rad ? from : start_rad;
    size_rad = size > size_rad ? size : size_rad;
    from = greatest[sector];
  }
  return {size_rad, size_rad > 0.0F ? start_rad + 0.5F * size_rad : 0.0F};
}

}  // namespace

Result<BoundaryTest> BoundaryTest::make(const Config& config, Arena& arena) noexcept {
  if (!is_positive(config.radius_mm) || !is_positive(config.min_gap_rad)) {
    return Errc::kInvalidArgument;
  }
  BoundaryTest stage(config, arena.take<Sectors>(kLanes), arena.take<Directions>(1));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

void BoundaryTest::Sectors::start(Vec3f its_point, Vec3f normal) noexcept {
  hit = 0;
  count = 0;
  std::fill_n(least, kSectors, std::numeric_limits<float>::max());
  std::fill_n(greatest, kSectors, -1.0F);
  point = its_point;
  // Without the smaller of x and y the vector across cannot vanish.
  const Vec3f across = std::fabs(normal.x) < std::fabs(normal.y) ? Vec3f{0.0F, normal.z, -normal.y}
                                                                 : Vec3f{-normal.z, 0.0F, normal.x};
  v = across * (1.0F / geometry::norm(across));
  u = geometry::cross(normal, v);
}

void BoundaryTest::Sectors::project(const search::NearView& points, float squared_radius,
                                    Directions& directions) noexcept {
  const Vec3Lanes at{splat(point.x), splat(point.y), splat(point.z)};
  const Vec3Lanes along_u{splat(u.x), splat(u.y), splat(u.z)};
  const Vec3Lanes along_v{splat(v.x), splat(v.y), splat(v.z)};
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const search::EightPoints p = search::EightPoints::of(points, i);
    const Vec3Lanes d{p.x - at.x, p.y - at.y, p.z - at.z};
    const FloatLanes squared = dot(d, d);
    const lanes::IntLanes near = squared <= splat(squared_radius);
    const FloatLanes a = dot(d, along_u);
    const FloatLanes b = dot(d, along_v);
    const FloatLanes sum = lanes::magnitude(a) + lanes::magnitude(b);
    const lanes::IntLanes has_angle = near & (squared * splat(kSquaredSteepness) < sum * sum);
    count += static_cast<std::uint32_t>(std::popcount(lanes::bits(near)));
    const std::uint32_t chosen = lanes::bits(has_angle);
    const lanes::LanePacker packer(chosen);
    packer.store(a, directions.a + kept);
    packer.store(b, directions.b + kept);
    kept += static_cast<std::size_t>(std::popcount(chosen));
  }
  directions.count = kept;
  lanes::store(splat(1.0F), directions.a + kept);  // What follows has an angle too, of no meaning.
  lanes::store(splat(0.0F), directions.b + kept);
}

void BoundaryTest::Sectors::add(const search::NearView& points, float squared_radius,
                                Directions& directions) noexcept {
  project(points, squared_radius, directions);
  float* const turns = directions.a;
  for (std::size_t i = 0; i < directions.count; i += kLanes) {
    const FloatLanes a = lanes::load(directions.a + i);
    const FloatLanes b = lanes::load(directions.b + i);
    const FloatLanes turn = turn_of(a, b, lanes::magnitude(a) + lanes::magnitude(b));
    lanes::store(turn, turns + i);
    lanes::store(lanes::to_int(lanes::min(turn * splat(kSectorsPerRad), splat(kLastSector))),
                 directions.sector + i);
  }
  for (std::size_t i = 0; i < directions.count; ++i) {
    const auto sector = static_cast<std::size_t>(directions.sector[i]);
    least[sector] = std::min(least[sector], turns[i]);
    greatest[sector] = std::max(greatest[sector], turns[i]);
    hit |= std::uint64_t{1} << sector;
  }
}

// The eight points of a cell.
class BoundaryTest::OfCell {
 public:
  OfCell(BoundaryTest& test, const search::CellTree& tree, const cloud::NormalsView& normals,
         BoundaryBuffer& out, Report& report) noexcept
      : test_(test), tree_(tree), normals_(normals), out_(out), report_(report) {}

  void start(std::uint32_t at) noexcept {
    const Cell& own = tree_.cells()[at];
    with_normal_ = 0;
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      const Vec3f normal = normal_of(own.index[i]);
      with_normal_ |= (normal == Vec3f{} ? 0U : 1U) << i;
      test_.sectors_[i].start({own.x[i], own.y[i], own.z[i]}, normal);
    }
  }
  void add(const search::QueryCell&, const search::NearView& points) noexcept {
    const float squared_radius = test_.config_.radius_mm * test_.config_.radius_mm;
    for (std::uint32_t left = with_normal_; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      test_.sectors_[i].add(points, squared_radius, test_.directions_[0]);
    }
  }
  void finish(std::uint32_t at) noexcept {
    const Cell& own = tree_.cells()[at];
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      test_.judge(own.index[i], normal_of(own.index[i]), test_.sectors_[i], out_, report_);
    }
  }

 private:
  [[nodiscard]] Vec3f normal_of(std::size_t index) const noexcept {
    return {normals_.nx[index], normals_.ny[index], normals_.nz[index]};
  }

  BoundaryTest& test_;
  const search::CellTree& tree_;
  const cloud::NormalsView& normals_;
  BoundaryBuffer& out_;
  Report& report_;
  std::uint32_t with_normal_ = 0;
};

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
  OfCell of_cell(*this, index.tree(), normals, out, report);
  index.for_each_cell(config_.radius_mm, of_cell);
  found.clear();
  for (std::uint32_t i = 0; i < num_points; ++i) {
    const bool open = out.gap_rad[i] > config_.min_gap_rad;
    report.dropped_full += open && !found.append(i) ? 1U : 0U;
    report.boundary += open ? 1U : 0U;
  }
  return report;
}

}  // namespace dseam::seam
