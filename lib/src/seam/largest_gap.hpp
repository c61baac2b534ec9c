// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "dseam/base/lanes.hpp"
#include "turn.hpp"

namespace dseam::seam {

/// Where the surface round a point is open; of equal gaps the first of the turn.
struct Gap {
  float size_rad;
  float middle_rad;
};

/// As unsigned numbers: what is negative counts as greater than the rest.
[[gnu::always_inline]] inline lanes::IntLanes lesser_unsigned(const lanes::IntLanes& a,
                                                              const lanes::IntLanes& b) noexcept {
  typedef unsigned UnsignedPart __attribute__((vector_size(sizeof(lanes::IntPart))));
  return lanes::IntLanes::each(
      [](auto p, auto q) {
        const auto up = __builtin_convertvector(p, UnsignedPart);
        const auto uq = __builtin_convertvector(q, UnsignedPart);
        return __builtin_convertvector(up < uq ? up : uq, lanes::IntPart);
      },
      a, b);
}

/// Of eight angles in (0, 2 pi] for each of kEights, in no order, some perhaps more than once.
///
/// Each looks for the next greater one. Positive floats order as their bits do, and what is not
/// greater wraps round to the far end of the unsigned, the least first: a subtraction and a minimum
/// a pair, which for so few is less than a sort. Written out, so that all stay in registers.
template <std::size_t... kEights>
[[nodiscard]] Gap largest_gap_of(const float* turns, std::index_sequence<kEights...>) noexcept {
  using lanes::FloatLanes;
  using lanes::IntLanes;
  using lanes::kLanes;
  using lanes::splat;
  const FloatLanes own[] = {lanes::load(turns + kEights * kLanes)...};
  const IntLanes after[] = {lanes::as_ints(own[kEights]) + splat(1)...};
  IntLanes ahead[] = {lanes::as_ints(own[kEights]) | splat(-1)...};
  for (std::size_t i = 0; i < sizeof...(kEights) * kLanes; ++i) {
    const IntLanes other = splat(std::bit_cast<std::int32_t>(turns[i]));
    ((ahead[kEights] = lesser_unsigned(ahead[kEights], other - after[kEights])), ...);
  }
  FloatLanes size = splat(0.0F);
  FloatLanes from = splat(0.0F);
  const auto compare = [&](const FloatLanes& turn, const IntLanes& next,
                           const IntLanes& off) noexcept {
    const IntLanes is_last = off < splat(0);
    const FloatLanes start = lanes::select(is_last, turn - splat(kFullTurn), turn);
    const FloatLanes its = lanes::as_floats(next) - start;
    const IntLanes better = (size < its) | ((size <= its) & (start < from));
    size = lanes::select(better, its, size);
    from = lanes::select(better, start, from);
  };
  (compare(own[kEights], after[kEights] + ahead[kEights], ahead[kEights]), ...);
  const float largest = lanes::largest(size);
  const FloatLanes starts = lanes::select(size < splat(largest), splat(kFullTurn), from);
  return {largest, lanes::least(starts) + 0.5F * largest};
}

/// Of at least one angle and at most forty; the list gets filled up to the next multiple of kLanes.
[[nodiscard]] inline Gap largest_gap_of(float* turns, std::size_t count) noexcept {
  lanes::store(lanes::splat(turns[0]), turns + count);  // One more of the same opens no gap.
  switch ((count + lanes::kLanes - 1) / lanes::kLanes) {
    case 1:
      return largest_gap_of(turns, std::make_index_sequence<1>{});
    case 2:
      return largest_gap_of(turns, std::make_index_sequence<2>{});
    case 3:
      return largest_gap_of(turns, std::make_index_sequence<3>{});
    case 4:
      return largest_gap_of(turns, std::make_index_sequence<4>{});
    default:
      return largest_gap_of(turns, std::make_index_sequence<5>{});
  }
}

}  // namespace dseam::seam
