// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

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
    const FloatLanes dx = lanes::splat(other.x[i]) - x;
    const FloatLanes dy = lanes::splat(other.y[i]) - y;
    const FloatLanes dz = lanes::splat(other.z[i]) - z;
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
  /// A mask with lane `i` alone.
  [[gnu::always_inline, nodiscard]] static IntLanes is_lane(std::size_t i) noexcept {
    static constexpr std::array<std::int32_t, kLanes> kNumbers = {0, 1, 2, 3, 4, 5, 6, 7};
    return lanes::load(kNumbers.data()) == lanes::splat(static_cast<std::int32_t>(i));
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
