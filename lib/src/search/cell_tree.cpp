// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/cell_tree.hpp"

#include <algorithm>
#include <limits>

#include "dseam/base/expects.hpp"
#include "dseam/search/query_cell.hpp"

namespace dseam::search {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

struct IndexedBox {
  Box box{kFar, kFar, kFar, -kFar, -kFar, -kFar};
  std::uint32_t first_index = kNoPoint;
};

// What is unused counts as the first, which is there; its index is greater than any other.
IndexedBox box_of_cell(const Cell& cell) noexcept {
  const QueryCell p(cell);
  return {{least(p.x), least(p.y), least(p.z), largest(p.x), largest(p.y), largest(p.z)},
          *std::min_element(cell.index, cell.index + kLanes)};
}

IndexedBox box_of_node(const Node& node) noexcept {
  IndexedBox all;
  for (std::size_t i = 0; i < kLanes; ++i) {
    Box& b = all.box;
    b = {std::min(b.low_x, node.low_x[i]),   std::min(b.low_y, node.low_y[i]),
         std::min(b.low_z, node.low_z[i]),   std::max(b.high_x, node.high_x[i]),
         std::max(b.high_y, node.high_y[i]), std::max(b.high_z, node.high_z[i])};
    all.first_index = std::min(all.first_index, node.first_index[i]);
  }
  return all;
}

void set_child(Node& node, std::size_t lane, const IndexedBox& child) noexcept {
  node.set(lane, child.box);
  node.first_index[lane] = child.first_index;
}

}  // namespace

void CellTree::build(std::size_t num_cells) noexcept {
  DSEAM_EXPECTS(num_cells <= cell_storage_.size());
  num_cells_ = num_cells;
  num_levels_ = 0;
  if (num_cells == 0) {
    return;
  }
  std::size_t begin = 0;
  for (std::size_t children = num_cells; num_levels_ == 0 || children > 1;) {
    level_begin_[num_levels_] = static_cast<std::uint32_t>(begin);
    build_level(num_levels_++, children);
    children = cells_of(children);
    begin += children;
  }
}

void CellTree::build_level(std::size_t level, std::size_t num_children) noexcept {
  const std::size_t begin = level_begin_[level];
  for (std::size_t child = 0; child < cells_of(num_children) * kLanes; ++child) {
    Node& node = node_storage_[begin + child / kLanes];
    if (child >= num_children) {
      set_child(node, child % kLanes, IndexedBox{});
    } else if (level == 0) {
      set_child(node, child % kLanes, box_of_cell(cell_storage_[child]));
    } else {
      set_child(node, child % kLanes, box_of_node(node_storage_[level_begin_[level - 1] + child]));
    }
  }
}

Box CellTree::box_of_only_block() const noexcept { return box_of_node(node_storage_[0]).box; }

}  // namespace dseam::search
