// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "dseam/base/lanes.hpp"

namespace dseam::search {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFFU;

/// Eight points that lie close together; unused places are infinitely far and have kNoPoint.
struct alignas(32) Cell {
  float x[kLanes];
  float y[kLanes];
  float z[kLanes];
  std::uint32_t index[kLanes];
};

/// An axis-aligned box; a point is one of no size.
struct Box {
  float low_x, low_y, low_z;
  float high_x, high_y, high_z;
};

/// The boxes of eight cells, or of eight nodes of the level below; unused ones are inside out.
struct alignas(32) Node {
  float low_x[kLanes];
  float low_y[kLanes];
  float low_z[kLanes];
  float high_x[kLanes];
  float high_y[kLanes];
  float high_z[kLanes];
  std::uint32_t first_index[kLanes];  ///< The least index in the box: ties go to it.

  void set(std::size_t lane, const Box& box) noexcept {
    low_x[lane] = box.low_x;
    low_y[lane] = box.low_y;
    low_z[lane] = box.low_z;
    high_x[lane] = box.high_x;
    high_y[lane] = box.high_y;
    high_z[lane] = box.high_z;
  }
  [[nodiscard]] Box box(std::size_t lane) const noexcept {
    return {low_x[lane], low_y[lane], low_z[lane], high_x[lane], high_y[lane], high_z[lane]};
  }
};

/// The least box around two.
[[nodiscard]] inline Box both(const Box& a, const Box& b) noexcept {
  return {std::min(a.low_x, b.low_x),   std::min(a.low_y, b.low_y),   std::min(a.low_z, b.low_z),
          std::max(a.high_x, b.high_x), std::max(a.high_y, b.high_y), std::max(a.high_z, b.high_z)};
}

/// Squared distances of `box` to the eight boxes of `node`. A float distance computed between any
/// two points inside is never less: subtraction, product and sum round monotonically.
[[nodiscard]] inline FloatLanes squared_gaps(const Node& node, const Box& box) noexcept {
  using lanes::load;
  using lanes::splat;
  const auto gap = [](const float* low, const float* high, float box_low, float box_high) noexcept {
    const FloatLanes outside = max(load(low) - splat(box_high), splat(box_low) - load(high));
    return max(outside, splat(0.0F));
  };
  const FloatLanes x = gap(node.low_x, node.high_x, box.low_x, box.high_x);
  const FloatLanes y = gap(node.low_y, node.high_y, box.low_y, box.high_y);
  const FloatLanes z = gap(node.low_z, node.high_z, box.low_z, box.high_z);
  return x * x + y * y + z * z;
}

/// How far a search still has to look.
struct Reach {
  float squared_mm2;               ///< Boxes beyond are left out.
  std::uint32_t index = kNoPoint;  ///< So are boxes at this distance with no index under this one.
};

/// Cells in the order of a space-filling curve, and eight-fold boxes over them: a tree without
/// pointers whose shape follows from the number of cells alone.
class CellTree {
 public:
  static constexpr std::size_t kMaxLevels = 10;  // 8^11 points are more than 32 bits can count.

  [[nodiscard]] static constexpr std::size_t cells_of(std::size_t points) noexcept {
    return (points + kLanes - 1) / kLanes;
  }
  [[nodiscard]] static constexpr std::size_t nodes_of(std::size_t cells) noexcept {
    std::size_t sum = 0;
    do {
      cells = (cells + kLanes - 1) / kLanes;
      sum += cells;
    } while (cells > 1);
    return sum;
  }

  CellTree() = default;
  CellTree(std::span<Cell> cells, std::span<Node> nodes) noexcept
      : cell_storage_(cells), node_storage_(nodes) {}

  /// To be filled before build().
  [[nodiscard]] std::span<Cell> storage() noexcept { return cell_storage_; }
  /// Computes the boxes over the first `num_cells` cells.
  void build(std::size_t num_cells) noexcept;

  [[nodiscard]] std::span<const Cell> cells() const noexcept {
    return cell_storage_.first(num_cells_);
  }
  [[nodiscard]] Box box_of(std::uint32_t cell) const noexcept {
    return node_storage_[cell / kLanes].box(cell % kLanes);
  }
  /// Eight cells with one parent are a block, the last one of fewer.
  [[nodiscard]] std::uint32_t num_blocks() const noexcept {
    return static_cast<std::uint32_t>(cells_of(num_cells_));
  }
  [[nodiscard]] static std::uint32_t block_of(std::uint32_t cell) noexcept {
    return cell / static_cast<std::uint32_t>(kLanes);
  }
  [[nodiscard]] static std::uint32_t first_of(std::uint32_t block) noexcept {
    return block * static_cast<std::uint32_t>(kLanes);
  }
  [[nodiscard]] std::uint32_t end_of(std::uint32_t block) const noexcept {
    return std::min(first_of(block + 1), static_cast<std::uint32_t>(num_cells_));
  }
  /// The boxes of its cells.
  [[nodiscard]] const Node& node_of(std::uint32_t block) const noexcept {
    return node_storage_[block];
  }
  [[nodiscard]] Box box_of_block(std::uint32_t block) const noexcept {
    return num_levels_ > 1 ? node_storage_[level_begin_[1] + block / kLanes].box(block % kLanes)
                           : box_of_only_block();
  }

  /// Calls `visit(cell)` for every cell within `reach()` of `box`, at each step down the tree but
  /// the last the nearest first. `reach` may shrink meanwhile.
  ///
  /// Time:    bounded by the number of cells; no recursion.
  template <typename ReachOf, typename Visit>
  void visit_nearest_first(const Box& box, const ReachOf& reach,
                           const Visit& visit) const noexcept {
    std::array<Open, kMaxLevels> open;
    std::size_t level = num_levels_ - 1;
    if (num_levels_ == 1) {
      visit_children(0, box, reach, visit);
    } else if (num_levels_ > 1) {
      open[level] = open_node(level, 0, box);
    }
    while (level > 0 && level < num_levels_) {
      const std::uint32_t lane = open[level].take_nearest(reach());
      const std::uint32_t child = first_of(open[level].number) + lane;
      if (lane == kLanes) {
        ++level;
      } else if (level == 1) {
        visit_children(child, box, reach, visit);
      } else {
        --level;
        open[level] = open_node(level, child, box);
      }
    }
  }
  /// Calls `visit(cell)` for `start`, then for every other cell within `reach()` of `box`, nearest
  /// relations first. `reach` may shrink meanwhile.
  ///
  /// Time:    bounded by the number of cells; no recursion.
  template <typename ReachOf, typename Visit>
  void visit_around(std::uint32_t start, const Box& box, const ReachOf& reach,
                    const Visit& visit) const noexcept {
    visit(start);
    visit_up<0>(start, box, reach, visit);
  }
  /// Calls `visit(block)` for `start`, then for every other block, in the order of visit_around().
  template <typename ReachOf, typename Visit>
  void visit_blocks_around(std::uint32_t start, const Box& box, const ReachOf& reach,
                           const Visit& visit) const noexcept {
    visit(start);
    visit_up<1>(start, box, reach, visit);
  }
  /// One bit for each cell of a block that lies within reach.
  [[nodiscard]] std::uint32_t near_cells(std::uint32_t block, const Box& box,
                                         float squared_mm2) const noexcept {
    return bits(squared_gaps(node_storage_[block], box) <= lanes::splat(squared_mm2));
  }

 private:
  struct Pending {
    std::uint32_t node;
    std::uint32_t children;  ///< One bit each.
  };

  /// A node some of whose children are still to be visited.
  struct Open {
    const Node* node;
    std::uint32_t number;
    FloatLanes gaps;  ///< Infinite once the child was taken.

    /// kLanes when none is within reach.
    [[nodiscard]] std::uint32_t take_nearest(Reach reach) noexcept {
      const float least = lanes::least(gaps);
      std::uint32_t nearest = bits(gaps <= lanes::splat(least));
      if (!(least <= reach.squared_mm2) || !(least < std::numeric_limits<float>::infinity())) {
        return kLanes;
      }
      if (least == reach.squared_mm2) {
        for (std::uint32_t left = nearest; left != 0; left &= left - 1) {
          const auto lane = static_cast<std::uint32_t>(std::countr_zero(left));
          nearest &= ~((node->first_index[lane] < reach.index ? 0U : 1U) << lane);
        }
      }
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(nearest | 1U << kLanes));
      gaps =
          select(lanes::is_lane(lane), lanes::splat(std::numeric_limits<float>::infinity()), gaps);
      return lane;
    }
  };
  [[nodiscard]] Open open_node(std::size_t level, std::uint32_t number,
                               const Box& box) const noexcept {
    const Node& node = node_storage_[level_begin_[level] + number];
    return {&node, number, squared_gaps(node, box)};
  }

  [[nodiscard]] std::uint32_t near_children(std::size_t level, std::uint32_t node, const Box& box,
                                            Reach reach) const noexcept {
    const Node& n = node_storage_[level_begin_[level] + node];
    const FloatLanes gaps = squared_gaps(n, box);
    const std::uint32_t nearer = bits(gaps < lanes::splat(reach.squared_mm2));
    std::uint32_t level_with = bits(gaps <= lanes::splat(reach.squared_mm2)) & ~nearer;
    std::uint32_t near = nearer;
    for (; level_with != 0; level_with &= level_with - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(level_with));
      near |= (n.first_index[lane] < reach.index ? 1U : 0U) << lane;
    }
    return near;
  }

  /// The cells of a lowest node: not worth an order.
  template <typename ReachOf, typename Visit>
  void visit_children(std::uint32_t node, const Box& box, const ReachOf& reach,
                      const Visit& visit) const noexcept {
    for (std::uint32_t left = near_children(0, node, box, reach()); left != 0; left &= left - 1) {
      visit(first_of(node) + static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }

  // Of cells (kLevel 0) or blocks (kLevel 1) all but `child`.
  template <std::size_t kLevel, typename ReachOf, typename Visit>
  void visit_up(std::uint32_t child, const Box& box, const ReachOf& reach,
                const Visit& visit) const noexcept {
    for (std::size_t level = kLevel; level < num_levels_; ++level) {
      const auto node = static_cast<std::uint32_t>(child / kLanes);
      const std::uint32_t others = near_children(level, node, box, reach());
      descend<kLevel>(level, node, others & ~(1U << (child % kLanes)), box, reach, visit);
      child = node;
    }
  }

  template <std::size_t kLevel, typename ReachOf, typename Visit>
  void descend(std::size_t top, std::uint32_t node, std::uint32_t children, const Box& box,
               const ReachOf& reach, const Visit& visit) const noexcept {
    std::array<Pending, kMaxLevels> pending;
    pending[top] = {node, children};
    for (std::size_t level = top; level <= top;) {
      Pending& at = pending[level];
      if (at.children == 0) {
        ++level;
        continue;
      }
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(at.children));
      at.children &= at.children - 1;
      const std::uint32_t child = at.node * static_cast<std::uint32_t>(kLanes) + lane;
      if (level == kLevel) {
        visit(child);
      } else {
        --level;
        pending[level] = {child, near_children(level, child, box, reach())};
      }
    }
  }

  [[nodiscard]] Box box_of_only_block() const noexcept;
  void build_level(std::size_t level, std::size_t num_children) noexcept;

  std::span<Cell> cell_storage_;
  std::span<Node> node_storage_;
  std::array<std::uint32_t, kMaxLevels> level_begin_{};
  std::size_t num_levels_ = 0;
  std::size_t num_cells_ = 0;
};

}  // namespace dseam::search
