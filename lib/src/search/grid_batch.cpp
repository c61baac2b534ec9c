// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "dseam/base/expects.hpp"
#include "dseam/search/grid_index.hpp"
#include "nearest_of_all.hpp"

namespace dseam::search {
namespace {

using lanes::splat;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// As many as there are others, so that no infinite distance enters.
template <std::size_t kRoom>
FloatLanes mean_of(const LeastDistances<kRoom>& distances, std::size_t k) noexcept {
  FloatLanes sum = splat(0.0F);
  for (std::size_t j = 0; j < k; ++j) {
    sum = sum + sqrt(distances.least[j]);
  }
  return sum / splat(static_cast<float>(k));
}

// Not inlined, so that the frames of the four lengths do not add up.
template <std::size_t kRoom>
[[gnu::noinline]] void mean_distances_of_all(const CellTree& tree, const NearPoints& near,
                                             std::size_t k, std::span<float> mean_mm) noexcept {
  NearestOfAll<kRoom> search(tree, near, k);
  search.run([&](std::uint32_t at, const LeastDistances<kRoom>& distances, bool) noexcept {
    const FloatLanes mean = mean_of(distances, k);
    const Cell& cell = tree.cells()[at];
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      mean_mm[cell.index[i]] = mean[i];
    }
  });
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
      offer(static_cast<std::size_t>(std::countr_zero(rows)), EightPoints::of(other));
    }
  }
  void offer(const NearView& points) noexcept {
    for (std::size_t row = 0; row < count_; ++row) {
      for (std::size_t i = 0; i < points.count; i += kLanes) {
        offer(row, EightPoints::of(points, i));
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
  void offer(std::size_t row, const EightPoints& points) noexcept {
    const FloatLanes dx = points.x - splat(cell_.x[row]);
    const FloatLanes dy = points.y - splat(cell_.y[row]);
    const FloatLanes dz = points.z - splat(cell_.z[row]);
    const FloatLanes squared = dx * dx + dy * dy + dz * dz;
    NearestList& list = lists_[row];
    std::uint32_t near = bits(squared <= splat(list.limit().squared_mm2));
    for (; near != 0; near &= near - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(near));
      const auto index = static_cast<std::uint32_t>(points.index[lane]);
      if (index != cell_.index[row]) {
        list.offer({index, squared[lane]});
      }
    }
  }

  const Cell& cell_;
  QueryCell query_;
  FloatLanes farthest_;
  std::array<NearestList, kLanes> lists_;
  std::size_t count_ = 0;
};

template <std::size_t kRoom>
[[gnu::noinline]] void rows_of_all(const CellTree& tree, const NearPoints& near, std::size_t k,
                                   std::size_t num_others, std::span<Neighbour> found) noexcept {
  NearestOfAll<kRoom> search(tree, near, std::min(k, num_others));
  search.run([&](std::uint32_t at, const LeastDistances<kRoom>& distances, bool covered) noexcept {
    const FloatLanes& farthest = distances.least[k - 1];
    Rows rows(tree.cells()[at], k, farthest, found);
    if (covered) {
      rows.offer(search.near().all_of(at, tree.box_of(at), largest(farthest)));
      return;
    }
    const auto reach = [&]() noexcept { return rows.reach(); };
    tree.visit_around(at, tree.box_of(at), reach, [&](std::uint32_t other) noexcept {
      rows.offer(tree.cells()[other], tree.box_of(other));
    });
  });
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
    mean_distances_of_all<5>(tree_, near_points(), k, mean_mm);
  } else if (k <= 10) {
    mean_distances_of_all<10>(tree_, near_points(), k, mean_mm);
  } else if (k <= 24) {
    mean_distances_of_all<24>(tree_, near_points(), k, mean_mm);
  } else {
    mean_distances_of_all<kMaxBatchNeighbours>(tree_, near_points(), k, mean_mm);
  }
}

void GridIndex::k_nearest_of_all(std::size_t k, std::span<Neighbour> found) const noexcept {
  DSEAM_EXPECTS(k > 0 && k <= kMaxBatchNeighbours);
  const std::size_t num_others = std::max<std::size_t>(size_, 2) - 1;
  if (k <= 5) {
    rows_of_all<5>(tree_, near_points(), k, num_others, found);
  } else if (k <= 10) {
    rows_of_all<10>(tree_, near_points(), k, num_others, found);
  } else if (k <= 24) {
    rows_of_all<24>(tree_, near_points(), k, num_others, found);
  } else {
    rows_of_all<kMaxBatchNeighbours>(tree_, near_points(), k, num_others, found);
  }
}

}  // namespace dseam::search
