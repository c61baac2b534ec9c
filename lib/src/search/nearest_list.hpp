// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace dseam::search
