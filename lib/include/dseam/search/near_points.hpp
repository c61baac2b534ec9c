// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/lane_packer.hpp"
#include "dseam/search/cell_tree.hpp"

namespace dseam::search {

/// Points by reference, for loops over eight at a time.
///
/// Shape:   readable to the next multiple of kLanes; what lies beyond `count` is infinitely far.
struct NearView {
  const float* x;
  const float* y;
  const float* z;
  const std::uint32_t* index;
  std::size_t count;
};

struct EightPoints {
  FloatLanes x, y, z;
  IntLanes index;

  [[gnu::always_inline, nodiscard]] static EightPoints of(const Cell& cell) noexcept {
    return {lanes::load(cell.x), lanes::load(cell.y), lanes::load(cell.z),
            lanes::load_lanes<IntLanes>(cell.index)};
  }
  [[gnu::always_inline, nodiscard]] static EightPoints of(const NearView& points,
                                                          std::size_t at) noexcept {
    return {lanes::load(points.x + at), lanes::load(points.y + at), lanes::load(points.z + at),
            lanes::load_lanes<IntLanes>(points.index + at)};
  }
};

/// Squared distances of eight points to a box. A float distance to a point inside is never less.
class BoxGaps {
 public:
  explicit BoxGaps(const Box& box) noexcept
      : low_x_(lanes::splat(box.low_x)),
        low_y_(lanes::splat(box.low_y)),
        low_z_(lanes::splat(box.low_z)),
        high_x_(lanes::splat(box.high_x)),
        high_y_(lanes::splat(box.high_y)),
        high_z_(lanes::splat(box.high_z)) {}

  [[gnu::always_inline, nodiscard]] FloatLanes squared_mm2(const EightPoints& p) const noexcept {
    const FloatLanes x = p.x - min(max(p.x, low_x_), high_x_);
    const FloatLanes y = p.y - min(max(p.y, low_y_), high_y_);
    const FloatLanes z = p.z - min(max(p.z, low_z_), high_z_);
    return x * x + y * y + z * z;
  }

 private:
  FloatLanes low_x_, low_y_, low_z_, high_x_, high_y_, high_z_;
};

/// An appendable list of points over lent storage.
class PointList {
 public:
  PointList(float* x, float* y, float* z, std::uint32_t* index, std::size_t capacity) noexcept
      : x_(x), y_(y), z_(z), index_(index), capacity_(capacity) {}

  void clear() noexcept { count_ = 0; }
  /// For all eight; else append() must not be called.
  [[nodiscard]] bool has_room() const noexcept { return count_ + kLanes <= capacity_; }
  /// Those whose bit is set.
  [[gnu::always_inline]] void append(const EightPoints& points, std::uint32_t bits) noexcept {
    lanes::LanePacker(bits).store(points.index, index_ + count_);
    append_places(points, bits);
  }
  /// The same without their indices.
  [[gnu::always_inline]] void append_places(const EightPoints& points,
                                            std::uint32_t bits) noexcept {
    const lanes::LanePacker packer(bits);
    packer.store(points.x, x_ + count_);
    packer.store(points.y, y_ + count_);
    packer.store(points.z, z_ + count_);
    count_ += static_cast<std::size_t>(std::popcount(bits));
  }
  /// Valid until the list changes.
  [[nodiscard]] NearView view() noexcept;

 private:
  float* x_;
  float* y_;
  float* z_;
  std::uint32_t* index_;
  std::size_t capacity_;
  std::size_t count_ = 0;
};

/// How far from a box points are wanted: squared distances in (above, upto].
struct Ring {
  float above_mm2;
  float upto_mm2;
};

/// The blocks of the tree around one of them, found once for its eight cells, and for each of the
/// eight the points that lie around it.
///
/// Memory:  34 kB, lent.
class NearPoints {
 public:
  static constexpr std::size_t kMostBlocks = 32;  ///< A bit each of an integer.
  static constexpr std::size_t kCapacity = kMostBlocks * kLanes * kLanes;

  struct Memory {
    alignas(32) float x[kCapacity + kLanes];
    alignas(32) float y[kCapacity + kLanes];
    alignas(32) float z[kCapacity + kLanes];
    alignas(32) std::uint32_t index[kCapacity + kLanes];
    std::uint32_t blocks[kMostBlocks];
    std::uint32_t cells[kMostBlocks * kLanes + kLanes];
  };

  NearPoints(const CellTree& tree, Memory& memory) noexcept
      : tree_(tree),
        memory_(memory),
        of_cell_(memory.x, memory.y, memory.z, memory.index, kCapacity) {}

  /// Finds the blocks within reach of `boxes`, one for each cell of `block`, all of them in
  /// `around`. False when they are too many.
  [[nodiscard]] bool collect(std::uint32_t block, const Node& boxes, const Box& around,
                             float squared_mm2) noexcept;

  /// Of what was collected the points around the box of cell `at` of that block, but its own;
  /// `ring` ends within the reach. With their indices, or without.
  template <bool kIndices>
  [[nodiscard]] NearView others_of(std::uint32_t at, const Box& box, Ring ring) noexcept;
  /// The points within the reach, with the cell's own, which come first.
  template <bool kIndices>
  [[nodiscard]] NearView all_of(std::uint32_t at, const Box& box, float squared_mm2) noexcept;

  /// The points of other cells around a box of points of cell `at`, whatever was collected. None
  /// when they are too many.
  [[nodiscard]] NearView others_around(std::uint32_t at, const Box& box,
                                       float squared_mm2) noexcept;

  /// What all_of() gives, in the same order, for a block that was not collected: `add` gets it in
  /// parts.
  template <typename Add>
  void in_parts(std::uint32_t at, float squared_mm2, const Add& add) noexcept {
    const Box box = tree_.box_of(at);
    const BoxGaps gaps(box);
    const FloatLanes limit = lanes::splat(squared_mm2);
    const auto take = [&](std::uint32_t cell) noexcept {
      if (!of_cell_.has_room()) {
        add(of_cell_.view());
        of_cell_.clear();
      }
      const EightPoints points = EightPoints::of(tree_.cells()[cell]);
      of_cell_.append(points, bits(gaps.squared_mm2(points) <= limit));
    };
    of_cell_.clear();
    tree_.visit_around(
        at, box, [squared_mm2]() noexcept { return Reach{squared_mm2}; }, take);
    add(of_cell_.view());
  }

 private:
  /// Into the memory; returns how many.
  [[nodiscard]] std::size_t find_cells(std::uint32_t at, const Box& box,
                                       float squared_mm2) noexcept;
  template <bool kIndices>
  void take_others(std::uint32_t at, const Box& box, Ring ring) noexcept;

  const CellTree& tree_;
  Memory& memory_;
  PointList of_cell_;
  IntLanes blocks_of_ = lanes::splat(0);  ///< For each of the eight which blocks lie around it.
};

}  // namespace dseam::search
