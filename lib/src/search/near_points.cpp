// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/near_points.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace dseam::search {
namespace {

constexpr float kNever = -1.0F;  // Nothing is nearer than that.

// Bit j of byte i becomes bit i of byte j.
constexpr std::uint64_t transposed(std::uint64_t bits) noexcept {
  const auto swap = [&](std::uint32_t distance, std::uint64_t mask) noexcept {
    const std::uint64_t differ = (bits ^ (bits >> distance)) & mask;
    bits ^= differ ^ (differ << distance);
  };
  swap(7, 0x00AA00AA00AA00AAULL);
  swap(14, 0x0000CCCC0000CCCCULL);
  swap(28, 0x00000000F0F0F0F0ULL);
  return bits;
}

// For each cell found one bit for each of the eight; wanted is the other way round.
class Masks {
 public:
  void set(std::size_t cell, std::uint32_t mask) noexcept {
    masks_[cell] = static_cast<std::uint8_t>(mask);
  }
  /// Those from `count` on are cleared first.
  void turn(std::size_t count, NearPoints::CellSet* sets) noexcept {
    std::fill(masks_.begin() + static_cast<std::ptrdiff_t>(count), masks_.end(), std::uint8_t{0});
    for (std::size_t own = 0; own < kLanes; ++own) {
      sets[own] = NearPoints::CellSet{};
    }
    for (std::size_t i = 0; i < count; i += 8) {
      const std::uint64_t turned = transposed(eight_at(i));
      for (std::size_t own = 0; own < kLanes; ++own) {
        sets[own].words[i / 64] |= (turned >> (own * 8) & 0xFFU) << (i % 64);
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t eight_at(std::size_t i) const noexcept {
    std::uint64_t eight = 0;
    for (std::size_t j = 0; j < 8; ++j) {
      eight |= std::uint64_t{masks_[i + j]} << (j * 8);
    }
    return eight;
  }

  std::array<std::uint8_t, NearPoints::kMostCells> masks_;
};

}  // namespace

NearView PointList::view() noexcept {
  const FloatLanes far = lanes::splat(std::numeric_limits<float>::infinity());
  lanes::store(far, x_ + count_);
  lanes::store(far, y_ + count_);
  lanes::store(far, z_ + count_);
  std::fill_n(index_ + count_, kLanes, kNoPoint);
  return {x_, y_, z_, index_, count_};
}

bool NearPoints::collect(std::uint32_t block, const Node& boxes, const Box& around,
                         Reaches reaches) noexcept {
  const FloatLanes near = lanes::splat(reaches.near_mm2);
  const FloatLanes far = lanes::splat(reaches.far_mm2);
  Masks are_near;
  Masks are_far;
  std::size_t count = 0;
  const auto add = [&](std::uint32_t cell) noexcept {
    const FloatLanes gaps = squared_gaps(boxes, tree_.box_of(cell));
    are_near.set(count, bits(gaps <= near));
    are_far.set(count, bits(gaps <= far));
    memory_.cells[count++] = cell;
  };
  for (std::uint32_t cell = tree_.first_of(block); cell < tree_.end_of(block); ++cell) {
    add(cell);
  }
  Reach reach{reaches.far_mm2};
  const auto reach_of = [&]() noexcept { return reach; };
  tree_.visit_beyond(block, around, reach_of, [&](std::uint32_t cell) noexcept {
    if (count < kMostCells) {
      add(cell);
    } else {
      reach.squared_mm2 = kNever;
    }
  });
  are_near.turn(count, memory_.near);
  are_far.turn(count, memory_.far);
  near_mm2_ = reaches.near_mm2;
  return reach.squared_mm2 != kNever;
}

template <bool kIndices>
void NearPoints::take(const CellSet& set, std::uint64_t but, const BoxGaps& gaps,
                      Ring ring) noexcept {
  const FloatLanes above = lanes::splat(ring.above_mm2);
  const FloatLanes upto = lanes::splat(ring.upto_mm2);
  const std::uint32_t* cells = memory_.cells;
  PointList list = of_cell_;
  for (const std::uint64_t word : set.words) {
    for (std::uint64_t left = word & ~std::exchange(but, 0); left != 0; left &= left - 1) {
      const EightPoints eight = EightPoints::of(tree_.cells()[cells[std::countr_zero(left)]]);
      const FloatLanes squared = gaps.squared_mm2(eight);
      const std::uint32_t wanted = bits((above < squared) & (squared <= upto));
      if constexpr (kIndices) {
        list.append(eight, wanted);
      } else {
        list.append_places(eight, wanted);
      }
    }
    cells += 64;
  }
  of_cell_ = list;
}

template <bool kIndices>
NearView NearPoints::others_of(std::uint32_t at, const Box& box, Ring ring) noexcept {
  const std::size_t own = at % kLanes;
  const CellSet& set = ring.upto_mm2 <= near_mm2_ ? memory_.near[own] : memory_.far[own];
  of_cell_.clear();
  take<kIndices>(set, std::uint64_t{1} << own, BoxGaps(box), ring);
  return of_cell_.view();
}

template NearView NearPoints::others_of<false>(std::uint32_t, const Box&, Ring) noexcept;
template NearView NearPoints::others_of<true>(std::uint32_t, const Box&, Ring) noexcept;

NearView NearPoints::all_of(std::uint32_t at, const Box& box, float squared_mm2) noexcept {
  const std::size_t own = at % kLanes;
  const BoxGaps gaps(box);
  const Ring ring{kNever, squared_mm2};
  of_cell_.clear();
  take<true>(CellSet{{std::uint64_t{1} << own}}, 0, gaps, ring);
  take<true>(memory_.far[own], std::uint64_t{1} << own, gaps, ring);
  return of_cell_.view();
}

NearView NearPoints::others_around(std::uint32_t at, const Box& box, float squared_mm2) noexcept {
  const BoxGaps gaps(box);
  const FloatLanes limit = lanes::splat(squared_mm2);
  of_cell_.clear();
  Reach reach{squared_mm2};
  const auto reach_of = [&]() noexcept { return reach; };
  tree_.visit_around(at, box, reach_of, [&](std::uint32_t cell) noexcept {
    if (cell == at) {
      return;
    }
    if (of_cell_.has_room()) {
      const EightPoints points = EightPoints::of(tree_.cells()[cell]);
      of_cell_.append(points, bits(gaps.squared_mm2(points) <= limit));
    } else {
      reach.squared_mm2 = kNever;
    }
  });
  if (reach.squared_mm2 == kNever) {
    of_cell_.clear();
  }
  return of_cell_.view();
}

}  // namespace dseam::search
