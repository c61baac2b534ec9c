// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "dseam/base/expects.hpp"
#include "dseam/search/grid_index.hpp"
#include "dseam/search/query_cell.hpp"
#include "nearest_list.hpp"

namespace dseam::search {
namespace {

using lanes::splat;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The kRoom least squared distances of each lane, in rising order, without a branch.
template <std::size_t kRoom>
struct LeastDistances {
  std::array<FloatLanes, kRoom> least;

  LeastDistances() noexcept { least.fill(splat(kInfinity)); }
  [[gnu::always_inline]] void insert(FloatLanes squared) noexcept {
    insert_each(squared, std::make_index_sequence<kRoom>{});
  }

 private:
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

// A point is no neighbour of its own.
template <std::size_t kRoom>
void insert_own(const QueryCell& query, const Cell& own, LeastDistances<kRoom>& best) noexcept {
  for (std::size_t i = 0; i < kLanes; ++i) {
    best.insert(select(query.is_lane(i), splat(kInfinity), query.squared_distances(own, i)));
  }
}

template <std::size_t kRoom>
void insert_other(const QueryCell& query, const Cell& cell, LeastDistances<kRoom>& best) noexcept {
  LeastDistances<kRoom> local = best;
  for (std::size_t i = 0; i < kLanes; ++i) {
    local.insert(query.squared_distances(cell, i));
  }
  best = local;
}

// For the eight points of `start`.
template <std::size_t kRoom>
void least_distances(const CellTree& tree, std::uint32_t start, std::size_t k,
                     LeastDistances<kRoom>& best) noexcept {
  const QueryCell query(tree.cells()[start]);
  FloatLanes farthest = splat(kInfinity);
  Reach of_all{kInfinity, 0};
  const auto reach = [&]() noexcept { return of_all; };
  tree.visit_around(start, tree.box_of(start), reach, [&](std::uint32_t at) noexcept {
    if (at == start) {
      insert_own(query, tree.cells()[at], best);
    } else if (query.any_nearer(tree.box_of(at), farthest)) {
      insert_other(query, tree.cells()[at], best);
    } else {
      return;
    }
    farthest = best.least[k - 1];
    of_all.squared_mm2 = largest(farthest);
  });
}

// As many as there are others, so that no infinite distance enters.
template <std::size_t kRoom>
FloatLanes mean_of(const LeastDistances<kRoom>& distances, std::size_t k) noexcept {
  FloatLanes sum = splat(0.0F);
  for (std::size_t j = 0; j < k; ++j) {
    sum = sum + sqrt(distances.least[j]);
  }
  return sum / splat(static_cast<float>(k));
}

template <std::size_t kRoom>
void mean_distances_of_all(const CellTree& tree, std::size_t k, std::span<float> mean_mm) noexcept {
  for (std::uint32_t at = 0; at < tree.cells().size(); ++at) {
    LeastDistances<kRoom> distances;
    least_distances(tree, at, k, distances);
    const FloatLanes mean = mean_of(distances, k);
    const Cell& cell = tree.cells()[at];
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      mean_mm[cell.index[i]] = mean[i];
    }
  }
}

// The rows of one cell. `farthest` is known from the distances alone; now the indices are wanted.
class Rows {
 public:
  Rows(const Cell& cell, std::size_t k, const FloatLanes& farthest,
       std::span<Neighbour> found) noexcept
      : cell_(cell), query_(cell), farthest_(farthest) {
    for (; count_ < kLanes && cell.index[count_] != kNoPoint; ++count_) {
      const std::span<Neighbour> row = found.subspan(cell.index[count_] * k, k);
      std::fill(row.begin(), row.end(), Neighbour{kNoPoint, kInfinity});
      lists_[count_] = NearestList(row, farthest[count_]);
    }
  }

  void offer(const Cell& other, const Box& box) noexcept {
    std::uint32_t rows = query_.bits_within(box, farthest_) & ((1U << count_) - 1U);
    for (; rows != 0; rows &= rows - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(rows));
      NearestList& list = lists_[i];
      const FloatLanes squared = squared_distances(other, cell_.x[i], cell_.y[i], cell_.z[i]);
      std::uint32_t near = bits(squared <= splat(list.limit().squared_mm2));
      for (; near != 0; near &= near - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(near));
        if (other.index[lane] != cell_.index[i]) {
          list.offer({other.index[lane], squared[lane]});
        }
      }
    }
  }
  [[nodiscard]] Reach reach() const noexcept {
    Reach reach{0.0F, 0};
    for (std::size_t i = 0; i < count_; ++i) {
      reach.squared_mm2 = std::max(reach.squared_mm2, lists_[i].limit().squared_mm2);
      reach.index = std::max(reach.index, lists_[i].limit().index);
    }
    return reach;
  }

 private:
  const Cell& cell_;
  QueryCell query_;
  FloatLanes farthest_;
  std::array<NearestList, kLanes> lists_;
  std::size_t count_ = 0;
};

template <std::size_t kRoom>
void rows_of_all(const CellTree& tree, std::size_t k, std::size_t num_others,
                 std::span<Neighbour> found) noexcept {
  for (std::uint32_t at = 0; at < tree.cells().size(); ++at) {
    LeastDistances<kRoom> distances;
    least_distances(tree, at, std::min(k, num_others), distances);
    Rows rows(tree.cells()[at], k, distances.least[k - 1], found);
    const auto reach = [&]() noexcept { return rows.reach(); };
    tree.visit_around(at, tree.box_of(at), reach, [&](std::uint32_t other) noexcept {
      rows.offer(tree.cells()[other], tree.box_of(other));
    });
  }
}

}  // namespace

void GridIndex::mean_distances(std::size_t k, std::span<float> mean_mm) const noexcept {
  DSEAM_EXPECTS(k > 0 && k <= kMaxBatchNeighbours);
  k = std::min(k, size_ - std::min<std::size_t>(size_, 1));
  if (k == 0) {
    for (const Cell& cell : tree_.cells()) {
      mean_mm[cell.index[0]] = 0.0F;  // A lone point.
    }
  } else if (k <= 5) {
    mean_distances_of_all<5>(tree_, k, mean_mm);
  } else if (k <= 10) {
    mean_distances_of_all<10>(tree_, k, mean_mm);
  } else if (k <= 24) {
    mean_distances_of_all<24>(tree_, k, mean_mm);
  } else {
    mean_distances_of_all<kMaxBatchNeighbours>(tree_, k, mean_mm);
  }
}

void GridIndex::k_nearest_of_all(std::size_t k, std::span<Neighbour> found) const noexcept {
  DSEAM_EXPECTS(k > 0 && k <= kMaxBatchNeighbours);
  const std::size_t num_others = std::max<std::size_t>(size_, 2) - 1;
  if (k <= 5) {
    rows_of_all<5>(tree_, k, num_others, found);
  } else if (k <= 10) {
    rows_of_all<10>(tree_, k, num_others, found);
  } else if (k <= 24) {
    rows_of_all<24>(tree_, k, num_others, found);
  } else {
    rows_of_all<kMaxBatchNeighbours>(tree_, k, num_others, found);
  }
}

}  // namespace dseam::search
