// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/grid_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nearest_list.hpp"

namespace dseam::search {
namespace {

using lanes::splat;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool is_in_range(geometry::Vec3f p) noexcept {
  return std::fabs(p.x) <= GridIndex::kMaxMm && std::fabs(p.y) <= GridIndex::kMaxMm &&
         std::fabs(p.z) <= GridIndex::kMaxMm;  // Written so that NaN fails it too.
}
bool are_in_range(const cloud::CloudView& cloud, std::size_t first) noexcept {
  const FloatLanes most = splat(GridIndex::kMaxMm);
  return bits((magnitude(lanes::load(&cloud.x[first])) <= most) &
              (magnitude(lanes::load(&cloud.y[first])) <= most) &
              (magnitude(lanes::load(&cloud.z[first])) <= most)) == 0xFFU;
}

// Keeps the nearest in a heap while more come than fit, and counts them all.
class RadiusList {
 public:
  explicit RadiusList(std::span<Neighbour> room) noexcept : room_(room) {}

  void add(const Neighbour& found) noexcept {
    if (count_++ < room_.size()) {
      room_[count_ - 1] = found;
      std::push_heap(room_.begin(), room_.begin() + static_cast<std::ptrdiff_t>(count_), is_before);
    } else if (!room_.empty() && is_before(found, room_.front())) {
      std::pop_heap(room_.begin(), room_.end(), is_before);
      room_.back() = found;
      std::push_heap(room_.begin(), room_.end(), is_before);
    }
  }
  std::size_t sort() noexcept {
    const std::size_t kept = std::min(count_, room_.size());
    std::sort_heap(room_.begin(), room_.begin() + static_cast<std::ptrdiff_t>(kept), is_before);
    return count_;
  }

 private:
  std::span<Neighbour> room_;
  std::size_t count_ = 0;
};

}  // namespace

Result<GridIndex> GridIndex::make(std::size_t max_points, Arena& arena) noexcept {
  if (max_points == 0 || max_points >= kNoPoint) {
    return Errc::kInvalidArgument;
  }
  GridIndex index(max_points, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return index;
}

GridIndex::GridIndex(std::size_t max_points, Arena& arena) noexcept
    : tree_(arena.take<Cell>(CellTree::cells_of(max_points)),
            arena.take<Node>(CellTree::nodes_of(CellTree::cells_of(max_points)))),
      places_(arena.take<CurvePlace>(max_points)),
      spare_(arena.take<CurvePlace>(max_points)),
      counters_(arena.take<std::uint32_t>(kCurveCounters)),
      near_memory_(arena.take<NearPoints::Memory>(1)) {}

GridIndex::Report GridIndex::rebuild(const cloud::CloudView& cloud) noexcept {
  const Report report = collect(cloud);
  size_ = report.num_indexed;
  sort_along_curve(cloud, kLanes, places_.first(size_), spare_.first(size_), counters_);
  fill_cells(cloud);
  tree_.build(CellTree::cells_of(size_));
  return report;
}

GridIndex::Report GridIndex::collect(const cloud::CloudView& cloud) noexcept {
  Report report;
  for (std::uint32_t i = 0; i < cloud.size();) {
    const bool eight =
        i + kLanes <= std::min(cloud.size(), places_.size()) && are_in_range(cloud, i);
    const std::uint32_t end = i + (eight ? static_cast<std::uint32_t>(kLanes) : 1U);
    if (!eight && !is_in_range(cloud[i])) {
      ++report.dropped_out_of_range;
      i = end;
    } else if (report.num_indexed == places_.size()) {
      ++report.dropped_full;
      i = end;
    }
    for (; i < end; ++i) {
      places_[report.num_indexed++].index = i;
    }
  }
  return report;
}

void GridIndex::fill_cells(const cloud::CloudView& cloud) noexcept {
  const std::span<Cell> cells = tree_.storage().first(CellTree::cells_of(size_));
  if (!cells.empty()) {
    Cell& last = cells.back();
    std::fill_n(last.x, kLanes, kInfinity);
    std::fill_n(last.y, kLanes, kInfinity);
    std::fill_n(last.z, kLanes, kInfinity);
    std::fill_n(last.index, kLanes, kNoPoint);
  }
  for (std::size_t i = 0; i < size_; ++i) {
    Cell& cell = cells[i / kLanes];
    const std::size_t lane = i % kLanes;
    const std::uint32_t index = places_[i].index;
    cell.x[lane] = cloud.x[index];
    cell.y[lane] = cloud.y[index];
    cell.z[lane] = cloud.z[index];
    cell.index[lane] = index;
  }
}

Neighbour GridIndex::nearest(geometry::Vec3f point, float max_mm) const noexcept {
  Neighbour found;
  if (!is_in_range(point) || size_ == 0) {
    return found;
  }
  NearestList list({&found, 1}, max_mm * max_mm);
  offer_all(tree_, point, list);
  return found;
}

std::size_t GridIndex::k_nearest(geometry::Vec3f point, std::span<Neighbour> found) const noexcept {
  if (!is_in_range(point) || size_ == 0 || found.empty()) {
    return 0;
  }
  NearestList list(found, kInfinity);
  offer_all(tree_, point, list);
  return list.size();
}

std::size_t GridIndex::radius(geometry::Vec3f point, float radius_mm,
                              std::span<Neighbour> found) const noexcept {
  if (!is_in_range(point) || size_ == 0 || !(radius_mm >= 0.0F)) {
    return 0;
  }
  const Box box = box_at(point);
  const float squared_radius = radius_mm * radius_mm;
  RadiusList list(found);
  const auto reach = [squared_radius]() noexcept { return Reach{squared_radius}; };
  tree_.visit_nearest_first(box, reach, [&](std::uint32_t at) noexcept {
    const Cell& cell = tree_.cells()[at];
    const FloatLanes squared = squared_distances(cell, point.x, point.y, point.z);
    std::uint32_t near = bits(squared <= splat(squared_radius));
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      list.add({cell.index[lane], squared[lane]});
    }
  });
  return list.sort();
}

namespace {

// The points within reach of another, behind those already found.
class Others {
 public:
  Others(geometry::Vec3f point, std::uint32_t index, float squared_mm2,
         std::span<Neighbour> found) noexcept
      : x_(lanes::splat(point.x)),
        y_(lanes::splat(point.y)),
        z_(lanes::splat(point.z)),
        limit_(splat(squared_mm2)),
        index_(splat(static_cast<std::int32_t>(index))),
        found_(found) {}

  void add(const EightPoints& points) noexcept {
    const FloatLanes dx = points.x - x_;
    const FloatLanes dy = points.y - y_;
    const FloatLanes dz = points.z - z_;
    const FloatLanes squared = dx * dx + dy * dy + dz * dz;
    const std::uint32_t near = bits(squared <= limit_) & ~bits(points.index == index_);
    const auto more = static_cast<std::size_t>(std::popcount(near));
    if (count_ + kLanes <= found_.size()) {
      const lanes::LanePacker packer(near);
      float distances[kLanes];
      std::uint32_t indices[kLanes];
      packer.store(squared, distances);
      packer.store(points.index, indices);
      for (std::size_t i = 0; i < kLanes; ++i) {
        found_[count_ + i] = {indices[i], distances[i]};
      }
    } else {
      add_some(points, squared, near);
    }
    count_ += more;
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  // Where not all eight would fit.
  void add_some(const EightPoints& points, const FloatLanes& squared, std::uint32_t near) noexcept {
    for (std::size_t at = count_; near != 0 && at < found_.size(); near &= near - 1, ++at) {
      const auto i = static_cast<std::size_t>(std::countr_zero(near));
      found_[at] = {static_cast<std::uint32_t>(points.index[i]), squared[i]};
    }
  }

  FloatLanes x_, y_, z_, limit_;
  IntLanes index_;
  std::span<Neighbour> found_;
  std::size_t count_ = 0;
};

geometry::Vec3f point_of(const Cell& cell, std::size_t lane) noexcept {
  return {cell.x[lane], cell.y[lane], cell.z[lane]};
}

}  // namespace

std::size_t GridIndex::others_in(const NearView& near, std::uint32_t at, std::size_t lane,
                                 float squared_mm2, std::span<Neighbour> found) const noexcept {
  const Cell& own = tree_.cells()[at];
  Others others(point_of(own, lane), own.index[lane], squared_mm2, found);
  for (std::size_t i = 0; i < near.count; i += kLanes) {
    others.add(EightPoints::of(near, i));
  }
  return others.count();
}

std::size_t GridIndex::others_within(std::uint32_t at, std::size_t lane, float squared_mm2,
                                     std::span<Neighbour> found) const noexcept {
  const Cell& own = tree_.cells()[at];
  const geometry::Vec3f point = point_of(own, lane);
  Others others(point, own.index[lane], squared_mm2, found);
  const auto reach = [squared_mm2]() noexcept { return Reach{squared_mm2}; };
  tree_.visit_around(at, box_at(point), reach, [&](std::uint32_t other) noexcept {
    others.add(EightPoints::of(tree_.cells()[other]));
  });
  return others.count();
}

}  // namespace dseam::search
