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

Box box_at(geometry::Vec3f p) noexcept { return {p.x, p.y, p.z, p.x, p.y, p.z}; }

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
      counters_(arena.take<std::uint32_t>(kCurveCounters)) {}

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
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!is_in_range(cloud[i])) {
      ++report.dropped_out_of_range;
    } else if (report.num_indexed == places_.size()) {
      ++report.dropped_full;
    } else {
      places_[report.num_indexed++].index = i;
    }
  }
  return report;
}

void GridIndex::fill_cells(const cloud::CloudView& cloud) noexcept {
  const std::span<Cell> cells = tree_.storage().first(CellTree::cells_of(size_));
  for (std::size_t i = 0; i < cells.size() * kLanes; ++i) {
    Cell& cell = cells[i / kLanes];
    const std::size_t lane = i % kLanes;
    const bool used = i < size_;
    const std::uint32_t index = used ? places_[i].index : kNoPoint;
    cell.x[lane] = used ? cloud.x[index] : kInfinity;
    cell.y[lane] = used ? cloud.y[index] : kInfinity;
    cell.z[lane] = used ? cloud.z[index] : kInfinity;
    cell.index[lane] = index;
  }
}

Neighbour GridIndex::nearest(geometry::Vec3f point, float max_mm) const noexcept {
  Neighbour found;
  if (!is_in_range(point) || size_ == 0) {
    return found;
  }
  NearestList list({&found, 1}, max_mm * max_mm);
  offer_all(point, list);
  return found;
}

std::size_t GridIndex::k_nearest(geometry::Vec3f point, std::span<Neighbour> found) const noexcept {
  if (!is_in_range(point) || size_ == 0 || found.empty()) {
    return 0;
  }
  NearestList list(found, kInfinity);
  offer_all(point, list);
  return list.size();
}

void GridIndex::offer_all(geometry::Vec3f point, NearestList& list) const noexcept {
  const Box box = box_at(point);
  const auto reach = [&]() noexcept { return Reach{list.limit().squared_mm2, list.limit().index}; };
  tree_.visit_around(tree_.cell_near(box), box, reach, [&](std::uint32_t at) noexcept {
    const Cell& cell = tree_.cells()[at];
    const FloatLanes squared = squared_distances(cell, point.x, point.y, point.z);
    std::uint32_t near = bits(squared <= splat(list.limit().squared_mm2));
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      list.offer({cell.index[lane], squared[lane]});
    }
  });
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
  tree_.visit_around(tree_.cell_near(box), box, reach, [&](std::uint32_t at) noexcept {
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

// The points of one cell within reach of another point, behind those already found.
class Others {
 public:
  Others(const Cell& own, std::size_t lane, Reach reach, std::span<Neighbour> found) noexcept
      : own_(own), lane_(lane), limit_(reach.squared_mm2), found_(found) {}

  void add(const Cell& cell) noexcept {
    const FloatLanes squared = squared_distances(cell, own_.x[lane_], own_.y[lane_], own_.z[lane_]);
    std::uint32_t near = bits(squared <= splat(limit_));
    near &= &cell == &own_ ? ~(1U << lane_) : ~0U;
    for (; near != 0; near &= near - 1, ++count_) {
      const auto i = static_cast<std::size_t>(std::countr_zero(near));
      if (count_ < found_.size()) {
        found_[count_] = {cell.index[i], squared[i]};
      }
    }
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  const Cell& own_;
  std::size_t lane_;
  float limit_;
  std::span<Neighbour> found_;
  std::size_t count_ = 0;
};

}  // namespace

GridIndex::NearCells GridIndex::cells_near(std::uint32_t at, Reach reach) const noexcept {
  NearCells near;
  const auto reach_of = [reach]() noexcept { return reach; };
  tree_.visit_around(at, tree_.box_of(at), reach_of, [&](std::uint32_t other) noexcept {
    near.all_fit = near.count < near.cells.size();
    if (near.all_fit) {
      near.cells[near.count++] = other;
    }
  });
  return near;
}

std::size_t GridIndex::others_in(const NearCells& near, std::uint32_t at, std::size_t lane,
                                 Reach reach, std::span<Neighbour> found) const noexcept {
  Others others(tree_.cells()[at], lane, reach, found);
  for (std::size_t i = 0; i < near.count; ++i) {
    others.add(tree_.cells()[near.cells[i]]);
  }
  return others.count();
}

std::size_t GridIndex::others_within(std::uint32_t at, std::size_t lane, Reach reach,
                                     std::span<Neighbour> found) const noexcept {
  const Cell& own = tree_.cells()[at];
  Others others(own, lane, reach, found);
  const auto reach_of = [reach]() noexcept { return reach; };
  tree_.visit_around(at, box_at({own.x[lane], own.y[lane], own.z[lane]}), reach_of,
                     [&](std::uint32_t other) noexcept { others.add(tree_.cells()[other]); });
  return others.count();
}

}  // namespace dseam::search
