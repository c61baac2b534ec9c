// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/search/cell_tree.hpp"
#include "dseam/search/curve_order.hpp"
#include "dseam/search/near_points.hpp"
#include "dseam/search/query_cell.hpp"

namespace dseam::search {

/// A point that was found: its index in the indexed cloud, and its squared distance.
struct Neighbour {
  std::uint32_t index = kNoPoint;
  float squared_mm2 = 0.0F;
};

/// Finds the nearest points of a cloud, exactly.
///
/// Points are sorted along a Hilbert curve over a grid, whose cells are divided further where they
/// hold too many, and packed eight to a cell. Distances are x*x + y*y + z*z in float; equal ones
/// are ordered by index, so the answer is unique. What is not finite, or further than kMaxMm from
/// the origin on an axis, is left out and counted.
///
/// Memory:  about 40 bytes a point and 34 kB; the indexed points are copied.
/// Time:    rebuild() is linear but for 10 more bits of grid where points crowd, at most 20 times;
///          queries visit only boxes that may hold an answer, whatever the points' distribution.
/// Context: real-time safe; after rebuild() any number of threads may query single points, and one
///          of them all points at once.
class GridIndex {
 public:
  static constexpr float kMaxMm = 1.0e7F;
  static constexpr float kUnlimitedMm = 1.0e19F;  ///< Its square is still finite.
  static constexpr std::size_t kMaxBatchNeighbours = 64;

  struct Report {
    std::uint32_t num_indexed = 0;
    std::uint32_t dropped_out_of_range = 0;  ///< Not finite, or beyond kMaxMm.
    std::uint32_t dropped_full = 0;          ///< Beyond the capacity given to make().
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    const std::size_t cells = CellTree::cells_of(max_points);
    return Arena::bytes<Cell>(cells) + Arena::bytes<Node>(CellTree::nodes_of(cells)) +
           2 * Arena::bytes<CurvePlace>(max_points) + Arena::bytes<std::uint32_t>(kCurveCounters) +
           Arena::bytes<NearPoints::Memory>(1);
  }
  /// kInvalidArgument: no point, or more than 32 bits count. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<GridIndex> make(std::size_t max_points, Arena& arena) noexcept;

  Report rebuild(const cloud::CloudView& cloud) noexcept;

  /// kNoPoint when there is none within `max_mm`.
  [[nodiscard]] Neighbour nearest(geometry::Vec3f point,
                                  float max_mm = kUnlimitedMm) const noexcept;
  /// The nearest `found.size()` points in rising order; returns how many there are.
  [[nodiscard]] std::size_t k_nearest(geometry::Vec3f point,
                                      std::span<Neighbour> found) const noexcept;
  /// The nearest points within `radius_mm` (its end included) in rising order, as many as fit into
  /// `found`; returns how many there are in all, which may be more.
  [[nodiscard]] std::size_t radius(geometry::Vec3f point, float radius_mm,
                                   std::span<Neighbour> found) const noexcept;

  /// For every indexed point its `k` nearest others, in rising order, in row `point` of `found`
  /// (k entries a row; kNoPoint where there are fewer). Rows of points left out are not touched.
  ///
  /// Errors:  a k over kMaxBatchNeighbours or too short a span is a broken precondition.
  void k_nearest_of_all(std::size_t k, std::span<Neighbour> found) const noexcept;
  /// For every indexed point the mean distance to its `k` nearest others (fewer where there are
  /// not as many), the paper's equation 2. Entries of points left out are not touched.
  void mean_distances(std::size_t k, std::span<float> mean_mm) const noexcept;

  /// For every indexed point, in the order of cells, `visit(point, neighbours)` with the others
  /// within `radius_mm` in no particular but always the same order. Of more than `scratch.size()`
  /// the first are given; returns how many points that befell.
  template <typename Visit>
  std::uint32_t for_each_radius(float radius_mm, std::span<Neighbour> scratch,
                                const Visit& visit) const noexcept;

  /// For stages that work on whole cells: for each one `work.start(cell)`, then
  /// `work.add(its points, near points)` once or more with what lies within `radius_mm` of the
  /// cell's box, its own points first, always in the same order and without indices, then
  /// `work.finish(cell)`.
  template <typename Work>
  void for_each_cell(float radius_mm, Work& work) const noexcept;

  [[nodiscard]] const CellTree& tree() const noexcept { return tree_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  GridIndex(std::size_t max_points, Arena& arena) noexcept;
  Report collect(const cloud::CloudView& cloud) noexcept;
  void fill_cells(const cloud::CloudView& cloud) noexcept;
  [[nodiscard]] NearPoints near_points() const noexcept { return {tree_, near_memory_[0]}; }
  /// Those within reach of point `lane` of a cell, without itself; returns how many there are.
  [[nodiscard]] std::size_t others_in(const NearView& near, std::uint32_t at, std::size_t lane,
                                      float squared_mm2, std::span<Neighbour> found) const noexcept;
  [[nodiscard]] std::size_t others_within(std::uint32_t at, std::size_t lane, float squared_mm2,
                                          std::span<Neighbour> found) const noexcept;

  CellTree tree_;
  std::span<CurvePlace> places_;
  std::span<CurvePlace> spare_;
  std::span<std::uint32_t> counters_;
  std::span<NearPoints::Memory> near_memory_;  ///< One.
  std::size_t size_ = 0;
};

template <typename Work>
void GridIndex::for_each_cell(float radius_mm, Work& work) const noexcept {
  const float squared_mm2 = radius_mm * radius_mm;
  NearPoints near = near_points();
  for (std::uint32_t block = 0; block < tree_.num_blocks(); ++block) {
    const bool fits =
        near.collect(block, tree_.node_of(block), tree_.box_of_block(block), squared_mm2);
    for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
      const QueryCell query(tree_.cells()[at]);
      const auto add = [&](const NearView& points) noexcept { work.add(query, points); };
      work.start(at);
      if (fits) {
        add(near.all_of<false>(at, tree_.box_of(at), squared_mm2));
      } else {
        near.in_parts(at, squared_mm2, add);
      }
      work.finish(at);
    }
  }
}

template <typename Visit>
std::uint32_t GridIndex::for_each_radius(float radius_mm, std::span<Neighbour> scratch,
                                         const Visit& visit) const noexcept {
  const float squared_mm2 = radius_mm * radius_mm;
  std::uint32_t num_cut_short = 0;
  NearPoints near = near_points();
  for (std::uint32_t block = 0; block < tree_.num_blocks(); ++block) {
    const bool fits =
        near.collect(block, tree_.node_of(block), tree_.box_of_block(block), squared_mm2);
    for (std::uint32_t at = CellTree::first_of(block); at < tree_.end_of(block); ++at) {
      const Cell& cell = tree_.cells()[at];
      const NearView points =
          fits ? near.all_of<true>(at, tree_.box_of(at), squared_mm2) : NearView{};
      for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
        const std::size_t count = fits ? others_in(points, at, i, squared_mm2, scratch)
                                       : others_within(at, i, squared_mm2, scratch);
        num_cut_short += count > scratch.size() ? 1U : 0U;
        const std::size_t kept = std::min(count, scratch.size());
        visit(cell.index[i], std::span<const Neighbour>(scratch.first(kept)));
      }
    }
  }
  return num_cut_short;
}

}  // namespace dseam::search
