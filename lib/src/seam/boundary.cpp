// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/boundary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "../geometry/vec3_lanes.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/base/lane_packer.hpp"
#include "largest_gap.hpp"
#include "turn.hpp"

namespace dseam::seam {
namespace {

using geometry::Vec3f;
using geometry::Vec3Lanes;
using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;
using lanes::splat;
using search::Cell;

constexpr float kSectorRad = kFullTurn / static_cast<float>(BoundaryTest::kSectors);
constexpr float kSectorsPerRad = static_cast<float>(BoundaryTest::kSectors) / kFullTurn;
constexpr float kLastSector = static_cast<float>(BoundaryTest::kSectors - 1);

// A neighbour straight along the normal, or in the same place, has no direction but rounding's.
constexpr float kSquaredSteepness = 1.0e-8F;

bool is_positive(float value) noexcept { return value > 0.0F && std::isfinite(value); }

// The tangent planes of eight points.
struct Plane {
  Vec3Lanes u;
  Vec3Lanes v;
};

Plane plane_across(const Vec3Lanes& normal) noexcept {
  // Without the smaller of x and y the vector across cannot vanish.
  const IntLanes x_is_less = lanes::magnitude(normal.x) < lanes::magnitude(normal.y);
  const FloatLanes zero = splat(0.0F);
  const Vec3Lanes across =
      geometry::select(x_is_less, Vec3Lanes{zero, normal.z, lanes::negated(normal.y)},
                       Vec3Lanes{lanes::negated(normal.z), zero, normal.x});
  const Vec3Lanes v = geometry::unit(across);
  return {geometry::cross(normal, v), v};
}

Vec3Lanes splat_of(const Vec3Lanes& eight, std::size_t i) noexcept {
  return {splat(eight.x[i]), splat(eight.y[i]), splat(eight.z[i])};
}

}  // namespace

Result<BoundaryTest> BoundaryTest::make(const Config& config, Arena& arena) noexcept {
  if (!is_positive(config.radius_mm) || !is_positive(config.min_gap_rad)) {
    return Errc::kInvalidArgument;
  }
  BoundaryTest stage(config, arena.take<Turns>(kLanes), arena.take<Offsets>(1));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

void BoundaryTest::Sectors::clear() noexcept {
  hit = 0;
  std::fill_n(least, kSectors, std::numeric_limits<float>::max());
  std::fill_n(greatest, kSectors, -1.0F);
}

void BoundaryTest::Sectors::add(const float* turns, std::size_t count) noexcept {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const FloatLanes scaled = lanes::load(turns + i) * splat(kSectorsPerRad);
    std::int32_t sectors[kLanes];
    lanes::store(lanes::to_int(lanes::min(scaled, splat(kLastSector))), sectors);
    for (std::size_t j = 0; j < std::min(kLanes, count - i); ++j) {
      const auto sector = static_cast<std::size_t>(sectors[j]);
      least[sector] = std::min(least[sector], turns[i + j]);
      greatest[sector] = std::max(greatest[sector], turns[i + j]);
      hit |= std::uint64_t{1} << sector;
    }
  }
}

Gap BoundaryTest::Sectors::largest_gap() const noexcept {
  const auto last = static_cast<std::size_t>(63 - std::countl_zero(hit));
  float from = greatest[last] - kFullTurn;
  Gap gap{0.0F, 0.0F};
  for (std::uint64_t left = hit; left != 0; left &= left - 1) {
    const auto sector = static_cast<std::size_t>(std::countr_zero(left));
    const float size_rad = least[sector] - from;
    gap = size_rad > gap.size_rad ? Gap{size_rad, from + 0.5F * size_rad} : gap;
    from = greatest[sector];
  }
  return gap;
}

void BoundaryTest::Turns::clear() noexcept {
  num_neighbours = 0;
  num_listed = 0;
  are_many = false;
}

void BoundaryTest::Turns::add(const float* turns, std::size_t count) noexcept {
  if (!are_many && num_listed + count <= kFew) {
    for (std::size_t i = 0; i < count; i += kLanes) {
      lanes::store(lanes::load(turns + i), list + num_listed + i);
    }
    num_listed += count;
    return;
  }
  if (!are_many) {
    are_many = true;
    sectors.clear();
    sectors.add(list, num_listed);
  }
  sectors.add(turns, count);
}

Gap BoundaryTest::Turns::largest_gap() noexcept {
  if (!are_many) {
    if (num_listed == 0) {
      return {kFullTurn, 0.0F};
    }
    const Gap gap = largest_gap_of(list, num_listed);
    // A smaller one may lie within a sector, where it is not to be seen.
    if (gap.size_rad > 2.0F * kSectorRad) {
      return gap;
    }
    sectors.clear();
    sectors.add(list, num_listed);
  }
  return sectors.largest_gap();
}

// The eight points of a cell.
class BoundaryTest::OfCell {
 public:
  OfCell(BoundaryTest& test, const search::CellTree& tree, const cloud::NormalsView& normals,
         BoundaryBuffer& out, Report& report) noexcept
      : test_(test), tree_(tree), normals_(normals), out_(out), report_(report) {}

  void start(std::uint32_t at) noexcept {
    const Cell& own = tree_.cells()[at];
    float x[kLanes] = {};
    float y[kLanes] = {};
    float z[kLanes] = {};
    with_normal_ = 0;
    used_ = 0;
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      x[i] = normals_.nx[own.index[i]];
      y[i] = normals_.ny[own.index[i]];
      z[i] = normals_.nz[own.index[i]];
      with_normal_ |= (Vec3f{x[i], y[i], z[i]} == Vec3f{} ? 0U : 1U) << i;
      used_ |= 1U << i;
      test_.turns_[i].clear();
    }
    plane_ = plane_across({lanes::load(x), lanes::load(y), lanes::load(z)});
  }

  void add(const search::QueryCell& query, const search::NearView& points) noexcept {
    const Vec3Lanes places{query.x, query.y, query.z};
    for (std::uint32_t left = with_normal_; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      Turns& turns = test_.turns_[i];
      const std::size_t near = find_near(points, splat_of(places, i));
      turns.num_neighbours += static_cast<std::uint32_t>(near);
      turns.add(test_.offsets_[0].x, turn_all(near, i));
    }
  }

  void finish(std::uint32_t at) noexcept {
    float size_rad[kLanes] = {};
    float middle_rad[kLanes] = {};
    std::uint32_t too_few = 0;
    for (std::uint32_t left = with_normal_; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      Turns& turns = test_.turns_[i];
      if (turns.num_neighbours > test_.config_.min_neighbours) {  // A point finds itself too.
        const Gap gap = turns.largest_gap();
        size_rad[i] = gap.size_rad;
        middle_rad[i] = gap.middle_rad;
      } else {
        too_few |= 1U << i;
      }
    }
    const FloatLanes sizes = lanes::load(size_rad);
    write(tree_.cells()[at], sizes, lanes::load(middle_rad));
    const std::uint32_t open = lanes::bits(splat(test_.config_.min_gap_rad) < sizes);
    report_.without_normal += count_of(used_ & ~with_normal_);
    report_.too_few += count_of(too_few);
    report_.inner += count_of(with_normal_ & ~too_few & ~open);
  }

 private:
  // Packs the offsets of those within the radius, the point itself among them; returns how many.
  std::size_t find_near(const search::NearView& points, const Vec3Lanes& place) noexcept {
    Offsets& to = test_.offsets_[0];
    const FloatLanes limit = splat(test_.config_.radius_mm * test_.config_.radius_mm);
    std::size_t found = 0;
    for (std::size_t i = 0; i < points.count; i += kLanes) {
      const FloatLanes x = lanes::load(points.x + i) - place.x;
      const FloatLanes y = lanes::load(points.y + i) - place.y;
      const FloatLanes z = lanes::load(points.z + i) - place.z;
      const std::uint32_t near = lanes::bits(x * x + y * y + z * z <= limit);
      const lanes::LanePacker packer(near);
      packer.store(x, to.x + found);
      packer.store(y, to.y + found);
      packer.store(z, to.z + found);
      found += static_cast<std::size_t>(std::popcount(near));
    }
    return found;
  }

  // Turns the first `count` offsets into angles in the tangent plane of point `i` and packs them
  // over x; returns how many have one.
  std::size_t turn_all(std::size_t count, std::size_t i) noexcept {
    Offsets& from = test_.offsets_[0];
    const Vec3Lanes u = splat_of(plane_.u, i);
    const Vec3Lanes v = splat_of(plane_.v, i);
    std::size_t kept = 0;
    for (std::size_t at = 0; at < count; at += kLanes) {
      const Vec3Lanes d{lanes::load(from.x + at), lanes::load(from.y + at),
                        lanes::load(from.z + at)};
      const FloatLanes a = dot(d, u);
      const FloatLanes b = dot(d, v);
      const FloatLanes sum = lanes::magnitude(a) + lanes::magnitude(b);
      const IntLanes has_angle = dot(d, d) * splat(kSquaredSteepness) < sum * sum;
      const std::uint32_t used = first_of(count - at) & lanes::bits(has_angle);
      lanes::LanePacker(used).store(turn_of(a, b, sum), from.x + kept);
      kept += static_cast<std::size_t>(std::popcount(used));
    }
    return kept;
  }

  void write(const Cell& own, const FloatLanes& size_rad, const FloatLanes& middle_rad) noexcept {
    const IntLanes is_before = middle_rad < splat(0.0F);
    const CosineSineLanes middle =
        cosine_sine(lanes::select(is_before, middle_rad + splat(kFullTurn), middle_rad));
    const IntLanes is_open = splat(0.0F) < size_rad;
    const Vec3Lanes towards = geometry::sum(geometry::scaled(plane_.u, middle.cosine),
                                            geometry::scaled(plane_.v, middle.sine));
    const Vec3Lanes open{lanes::keep(is_open, towards.x), lanes::keep(is_open, towards.y),
                         lanes::keep(is_open, towards.z)};
    for (std::size_t i = 0; i < kLanes && own.index[i] != search::kNoPoint; ++i) {
      out_.gap_rad[own.index[i]] = size_rad[i];
      out_.open_x[own.index[i]] = open.x[i];
      out_.open_y[own.index[i]] = open.y[i];
      out_.open_z[own.index[i]] = open.z[i];
    }
  }

  [[nodiscard]] static std::uint32_t count_of(std::uint32_t bits) noexcept {
    return static_cast<std::uint32_t>(std::popcount(bits));
  }
  [[nodiscard]] static std::uint32_t first_of(std::size_t count) noexcept {
    return 0xFFU >> (kLanes - std::min(count, kLanes));
  }

  BoundaryTest& test_;
  const search::CellTree& tree_;
  const cloud::NormalsView& normals_;
  BoundaryBuffer& out_;
  Report& report_;
  Plane plane_{};
  std::uint32_t with_normal_ = 0;
  std::uint32_t used_ = 0;
};

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
