// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/cell_tree.hpp"

#include <algorithm>
#include <limits>

#include "dseam/base/expects.hpp"

namespace dseam::search {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

struct IndexedBox {
  Box box{kFar, kFar, kFar, -kFar, -kFar, -kFar};
  std::uint32_t first_index = kNoPoint;
};

// Cells are filled from the front, and so are nodes: what is unused lies at the end.
IndexedBox box_of_cell(const Cell& cell) noexcept {
  IndexedBox all;
  for (std::size_t i = 0; i < kLanes && cell.index[i] != kNoPoint; ++i) {
    Box& b = all.box;
    b = {std::min(b.low_x, cell.x[i]),  std::min(b.low_y, cell.y[i]),
         std::min(b.low_z, cell.z[i]),  std::max(b.high_x, cell.x[i]),
         std::max(b.high_y, cell.y[i]), std::max(b.high_z, cell.z[i])};
    all.first_index = std::min(all.first_index, cell.index[i]);
  }
  return all;
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

Box CellTree::box_of_block(std::uint32_t block) const noexcept {
  return box_of_node(node_storage_[block]).box;
}

}  // namespace dseam::search
