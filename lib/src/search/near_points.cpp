// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/near_points.hpp"

#include <algorithm>
#include <limits>

namespace dseam::search {
namespace {

constexpr float kNever = -1.0F;  // Nothing is nearer than that.

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
                         float squared_mm2) noexcept {
  static_assert(kMostBlocks <= 32);
  std::size_t count = 0;
  IntLanes blocks_of = lanes::splat(0);
  Reach reach{squared_mm2};
  const auto reach_of = [&]() noexcept { return reach; };
  tree_.visit_blocks_around(block, around, reach_of, [&](std::uint32_t other) noexcept {
    if (count == kMostBlocks) {
      reach.squared_mm2 = kNever;
      return;
    }
    const IntLanes near =
        squared_gaps(boxes, tree_.box_of_block(other)) <= lanes::splat(squared_mm2);
    blocks_of = blocks_of | (near & lanes::splat(static_cast<std::int32_t>(1U << count)));
    memory_.blocks[count++] = other;
  });
  blocks_of_ = blocks_of;
  return reach.squared_mm2 != kNever;
}

// The cells first, then their points: one loop in another would end where nobody can foresee it.
std::size_t NearPoints::find_cells(std::uint32_t at, const Box& box, float squared_mm2) noexcept {
  constexpr std::int32_t kNumbers[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  std::size_t count = 0;
  auto blocks = static_cast<std::uint32_t>(blocks_of_[at % kLanes]);
  for (; blocks != 0; blocks &= blocks - 1) {
    const std::uint32_t block = memory_.blocks[std::countr_zero(blocks)];
    const std::uint32_t own = block == CellTree::block_of(at) ? 1U << (at % kLanes) : 0U;
    const std::uint32_t near = tree_.near_cells(block, box, squared_mm2) & ~own;
    const IntLanes cells =
        lanes::load(kNumbers) + lanes::splat(static_cast<std::int32_t>(CellTree::first_of(block)));
    lanes::LanePacker(near).store(cells, memory_.cells + count);
    count += static_cast<std::size_t>(std::popcount(near));
  }
  return count;
}

template <bool kIndices>
void NearPoints::take_others(std::uint32_t at, const Box& box, Ring ring) noexcept {
  const BoxGaps gaps(box);
  const FloatLanes above = lanes::splat(ring.above_mm2);
  const FloatLanes upto = lanes::splat(ring.upto_mm2);
  const std::size_t count = find_cells(at, box, ring.upto_mm2);
  PointList list = of_cell_;  // In registers.
  for (std::size_t i = 0; i < count; ++i) {
    const EightPoints eight = EightPoints::of(tree_.cells()[memory_.cells[i]]);
    const FloatLanes squared = gaps.squared_mm2(eight);
    const std::uint32_t wanted = bits((above < squared) & (squared <= upto));
    if constexpr (kIndices) {
      list.append(eight, wanted);
    } else {
      list.append_places(eight, wanted);
    }
  }
  of_cell_ = list;
}

template <bool kIndices>
NearView NearPoints::others_of(std::uint32_t at, const Box& box, Ring ring) noexcept {
  of_cell_.clear();
  take_others<kIndices>(at, box, ring);
  return of_cell_.view();
}
template NearView NearPoints::others_of<false>(std::uint32_t, const Box&, Ring) noexcept;
template NearView NearPoints::others_of<true>(std::uint32_t, const Box&, Ring) noexcept;

template <bool kIndices>
NearView NearPoints::all_of(std::uint32_t at, const Box& box, float squared_mm2) noexcept {
  const EightPoints own = EightPoints::of(tree_.cells()[at]);
  of_cell_.clear();
  of_cell_.append(own, bits(BoxGaps(box).squared_mm2(own) <= lanes::splat(squared_mm2)));
  take_others<kIndices>(at, box, {kNever, squared_mm2});
  return of_cell_.view();
}
template NearView NearPoints::all_of<false>(std::uint32_t, const Box&, float) noexcept;
template NearView NearPoints::all_of<true>(std::uint32_t, const Box&, float) noexcept;

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
