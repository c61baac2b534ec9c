// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

#include "dseam/search/near_points.hpp"
#include "dseam/search/query_cell.hpp"

namespace dseam::search {

/// The kRoom least squared distances of each lane, in rising order, without a branch.
template <std::size_t kRoom>
struct LeastDistances {
  std::array<FloatLanes, kRoom> least;

  LeastDistances() noexcept { least.fill(lanes::splat(std::numeric_limits<float>::infinity())); }
  [[gnu::always_inline]] void insert(FloatLanes squared) noexcept {
    insert_each(squared, std::make_index_sequence<kRoom>{});
  }
  /// The other points of the eight's own cell: a point is no neighbour of its own.
  void insert_own(const QueryCell& query, const Cell& own) noexcept {
    Working local = *this;
    const FloatLanes never = lanes::splat(std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < kLanes; ++i) {
      local.insert(select(lanes::is_lane(i), never, query.squared_distances(own, i)));
    }
    *this = local;
  }
  void insert_cell(const QueryCell& query, const Cell& cell) noexcept {
    Working local = *this;
    for (std::size_t i = 0; i < kLanes; ++i) {
      local.insert(query.squared_distances(cell, i));
    }
    *this = local;
  }
  void insert_all(const QueryCell& eight, const NearView& points) noexcept {
    Working local = *this;
    const QueryCell query = eight;
    for (std::size_t i = 0; i < points.count; ++i) {
      local.insert(query.squared_distances(points.x[i], points.y[i], points.z[i]));
    }
    *this = local;
  }

 private:
  // Short lists are worked on in registers; long ones would not fit there.
  using Working = std::conditional_t<(kRoom <= 10), LeastDistances, LeastDistances&>;
  // Written out, so that short lists stay in registers.
  template <std::size_t... kPlaces>
  [[gnu::always_inline]] void insert_each(FloatLanes squared,
                                          std::index_sequence<kPlaces...>) noexcept {
    (insert_at(least[kPlaces], squared), ...);
  }
  [[gnu::always_inline]] static void insert_at(FloatLanes& kept, FloatLanes& squared) noexcept {
    const FloatLanes nearer = min(kept, squared);
    squared = max(kept, squared);
    kept = nearer;
  }
};

}  // namespace dseam::search
