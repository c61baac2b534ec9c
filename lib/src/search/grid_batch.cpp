// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "dseam/base/expects.hpp"
#include "dseam/search/grid_index.hpp"
#include "least_distances.hpp"
#include "least_neighbours.hpp"
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
    sum = sum + sqrt(distances.squared_mm2(j));
  }
  return sum / splat(static_cast<float>(k));
}

// Not inlined, so that the frames of the four lengths do not add up.
template <std::size_t kRoom>
[[gnu::noinline]] void mean_distances_of_all(const CellTree& tree, const NearPoints& near,
                                             std::size_t k, std::span<float> mean_mm) noexcept {
  NearestOfAll<LeastDistances<kRoom>> search(tree, near, k);
  search.run([&](std::uint32_t at, const LeastDistances<kRoom>& distances) noexcept {
    const FloatLanes mean = mean_of(distances, k);
    const Cell& cell = tree.cells()[at];
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      mean_mm[cell.index[i]] = mean[i];
    }
  });
}

template <std::size_t kRoom>
[[gnu::noinline]] void rows_of_all(const CellTree& tree, const NearPoints& near, std::size_t k,
                                   std::size_t num_others, std::span<Neighbour> found) noexcept {
  NearestOfAll<LeastNeighbours<kRoom>> search(tree, near, std::min(k, num_others));
  search.run([&](std::uint32_t at, const LeastNeighbours<kRoom>& nearest) noexcept {
    const Cell& cell = tree.cells()[at];
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      Neighbour* row = &found[cell.index[i] * k];
      for (std::size_t j = 0; j < k; ++j) {
        row[j] = nearest(i, j);
      }
    }
  });
}

// One at a time, for lists so long that those of eight points would not fit on the stack.
void long_rows_of_all(const CellTree& tree, std::size_t k, std::span<Neighbour> found) noexcept {
  for (const Cell& cell : tree.cells()) {
    for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
      std::array<Neighbour, GridIndex::kMaxBatchNeighbours + 1> room;
      room.fill(Neighbour{kNoPoint, kInfinity});
      NearestList list({room.data(), k + 1}, kInfinity);
      offer_all(tree, {cell.x[i], cell.y[i], cell.z[i]}, list);
      const auto self = std::find_if(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(k),
                                     [&](const Neighbour& n) { return n.index == cell.index[i]; });
      std::copy(self + 1, room.begin() + static_cast<std::ptrdiff_t>(k) + 1, self);
      std::copy_n(room.begin(), k, &found[cell.index[i] * k]);
    }
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
    long_rows_of_all(tree_, k, found);
  }
}

}  // namespace dseam::search
