// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <type_traits>

#include "dseam/search/near_points.hpp"
#include "dseam/search/query_cell.hpp"
#include "least.hpp"
#include "nearest_list.hpp"

namespace dseam::search {

/// The kRoom least squared distances of each of eight points, in rising order.
template <std::size_t kRoom>
class LeastDistances {
 public:
  static constexpr std::size_t kMost = kRoom;
  static constexpr bool kIndices = false;  ///< Not wanted of the points that are offered.

  LeastDistances() noexcept { clear(); }
  void clear() noexcept { of_.least.fill(lanes::splat(std::numeric_limits<float>::infinity())); }

  /// The other points of the eight's own cell: a point is no neighbour of its own.
  void insert_own(const QueryCell& query, const Cell& own) noexcept {
    Working local = of_;
    const FloatLanes never = lanes::splat(std::numeric_limits<float>::infinity());
    const auto squared = [&](std::size_t i) noexcept {
      return select(lanes::is_lane(i), never, query.squared_distances(own, i));
    };
    local.insert_four(squared(0), squared(1), squared(2), squared(3));
    local.insert_four(squared(4), squared(5), squared(6), squared(7));
    of_ = local;
  }
  void insert_cell(const QueryCell& query, const Cell& cell) noexcept {
    insert(query, cell.x, cell.y, cell.z, kLanes);
  }
  void insert_all(const QueryCell& query, const NearView& points) noexcept {
    insert(query, points.x, points.y, points.z, points.count);
  }
  void set(std::size_t lane, std::size_t place, const Neighbour& its) noexcept {
    of_.least[place] =
        select(lanes::is_lane(lane), lanes::splat(its.squared_mm2), of_.least[place]);
  }
  /// What another list has of one of the eight.
  void take(const LeastDistances& other, std::size_t lane) noexcept {
    const IntLanes its = lanes::is_lane(lane);
    for (std::size_t i = 0; i < kRoom; ++i) {
      of_.least[i] = select(its, other.of_.least[i], of_.least[i]);
    }
  }

  [[nodiscard]] const FloatLanes& squared_mm2(std::size_t place) const noexcept {
    return of_.least[place];
  }
  /// What may still change the first `k`.
  [[nodiscard]] Reach reach(std::size_t k) const noexcept { return {largest(of_.least[k - 1]), 0}; }
  [[nodiscard]] bool may_take(const QueryCell& query, const Box& box,
                              std::size_t k) const noexcept {
    return query.any_nearer(box, of_.least[k - 1]);
  }

 private:
  using List = Least<FloatLanes, kRoom>;
  // Short lists are worked on in registers; long ones would not fit there.
  using Working = std::conditional_t<(kRoom <= 10), List, List&>;

  // The arrays are readable to the next multiple of eight, and infinitely far there.
  [[gnu::always_inline]] void insert(const QueryCell& eight, const float* x, const float* y,
                                     const float* z, std::size_t count) noexcept {
    Working local = of_;
    const QueryCell query = eight;
    const auto squared = [&](std::size_t i) noexcept {
      return query.squared_distances(x[i], y[i], z[i]);
    };
    for (std::size_t i = 0; i < count; i += 4) {
      local.insert_four(squared(i), squared(i + 1), squared(i + 2), squared(i + 3));
    }
    of_ = local;
  }

  List of_;
};

}  // namespace dseam::search
