// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/search/cell_tree.hpp"

namespace dseam::search {

/// The eight points of a cell as eight questions asked at once, one a lane.
///
/// Lanes without a point repeat the first; their answers are to be thrown away.
class QueryCell {
 public:
  explicit QueryCell(const Cell& cell) noexcept {
    const IntLanes used = lanes::load_lanes<IntLanes>(cell.index);
    const IntLanes empty = used == lanes::splat(static_cast<std::int32_t>(kNoPoint));
    x = select(empty, lanes::splat(cell.x[0]), lanes::load(cell.x));
    y = select(empty, lanes::splat(cell.y[0]), lanes::load(cell.y));
    z = select(empty, lanes::splat(cell.z[0]), lanes::load(cell.z));
  }

  /// To point `i` of another cell.
  [[gnu::always_inline, nodiscard]] FloatLanes squared_distances(const Cell& other,
                                                                 std::size_t i) const noexcept {
    return squared_distances(other.x[i], other.y[i], other.z[i]);
  }
  [[gnu::always_inline, nodiscard]] FloatLanes squared_distances(float to_x, float to_y,
                                                                 float to_z) const noexcept {
    const FloatLanes dx = lanes::splat(to_x) - x;
    const FloatLanes dy = lanes::splat(to_y) - y;
    const FloatLanes dz = lanes::splat(to_z) - z;
    return dx * dx + dy * dy + dz * dz;
  }
  /// Whether the box comes nearer to any of the eight than its own squared limit.
  [[gnu::always_inline, nodiscard]] bool any_nearer(const Box& box,
                                                    const FloatLanes& limit) const noexcept {
    return bits(squared_gaps(box) < limit) != 0;
  }
  /// One bit for each of the eight to which the box comes within the squared limit.
  [[gnu::always_inline, nodiscard]] std::uint32_t bits_within(
      const Box& box, const FloatLanes& limit) const noexcept {
    return bits(squared_gaps(box) <= limit);
  }

  FloatLanes x;
  FloatLanes y;
  FloatLanes z;

 private:
  [[gnu::always_inline, nodiscard]] FloatLanes squared_gaps(const Box& box) const noexcept {
    const FloatLanes zero = lanes::splat(0.0F);
    const FloatLanes gx = max(max(lanes::splat(box.low_x) - x, x - lanes::splat(box.high_x)), zero);
    const FloatLanes gy = max(max(lanes::splat(box.low_y) - y, y - lanes::splat(box.high_y)), zero);
    const FloatLanes gz = max(max(lanes::splat(box.low_z) - z, z - lanes::splat(box.high_z)), zero);
    return gx * gx + gy * gy + gz * gz;
  }
};

}  // namespace dseam::search
