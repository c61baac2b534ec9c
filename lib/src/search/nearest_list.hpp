// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <limits>
#include <span>

#include "dseam/search/grid_index.hpp"

namespace dseam::search {

[[nodiscard]] constexpr bool is_before(const Neighbour& a, const Neighbour& b) noexcept {
  return a.squared_mm2 < b.squared_mm2 || (a.squared_mm2 == b.squared_mm2 && a.index < b.index);
}

/// The first of all neighbours offered, in rising order of distance and then of index.
class NearestList {
 public:
  NearestList() = default;
  /// `farthest_mm2`: what lies beyond is refused.
  NearestList(std::span<Neighbour> room, float farthest_mm2) noexcept
      : room_(room), limit_{kNoPoint, farthest_mm2} {}

  void offer(const Neighbour& offered) noexcept {
    if (!is_before(offered, limit_)) {
      return;
    }
    std::size_t at = size_ < room_.size() ? size_++ : size_ - 1;
    for (; at > 0 && is_before(offered, room_[at - 1]); --at) {
      room_[at] = room_[at - 1];
    }
    room_[at] = offered;
    if (size_ == room_.size()) {
      limit_ = room_[size_ - 1];
    }
  }

  void offer(const EightPoints& points, geometry::Vec3f to) noexcept {
    const FloatLanes dx = points.x - lanes::splat(to.x);
    const FloatLanes dy = points.y - lanes::splat(to.y);
    const FloatLanes dz = points.z - lanes::splat(to.z);
    const FloatLanes squared = dx * dx + dy * dy + dz * dz;
    std::uint32_t near = bits(squared <= lanes::splat(limit_.squared_mm2));
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      offer({static_cast<std::uint32_t>(points.index[lane]), squared[lane]});
    }
  }

  /// Only what is before this is taken.
  [[nodiscard]] const Neighbour& limit() const noexcept { return limit_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<Neighbour> room_;
  Neighbour limit_;
  std::size_t size_ = 0;
};

/// Squared distances of one point to the eight of a cell; infinite for unused places.
[[nodiscard]] inline FloatLanes squared_distances(const Cell& cell, float x, float y,
                                                  float z) noexcept {
  const FloatLanes dx = lanes::load(cell.x) - lanes::splat(x);
  const FloatLanes dy = lanes::load(cell.y) - lanes::splat(y);
  const FloatLanes dz = lanes::load(cell.z) - lanes::splat(z);
  return dx * dx + dy * dy + dz * dz;
}

[[nodiscard]] inline Box box_at(geometry::Vec3f p) noexcept {
  return {p.x, p.y, p.z, p.x, p.y, p.z};
}

/// Offers every point that the list may take.
inline void offer_all(const CellTree& tree, geometry::Vec3f point, NearestList& list) noexcept {
  const Box box = box_at(point);
  const auto reach = [&]() noexcept { return Reach{list.limit().squared_mm2, list.limit().index}; };
  tree.visit_nearest_first(box, reach, [&](std::uint32_t at) noexcept {
    list.offer(EightPoints::of(tree.cells()[at]), point);
  });
}

}  // namespace dseam::search
