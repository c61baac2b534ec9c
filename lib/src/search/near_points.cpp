// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/near_points.hpp"

#include <algorithm>
#include <limits>

namespace dseam::search {
namespace {

constexpr std::uint32_t kAll = 0xFFU;
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

bool NearPoints::collect(std::uint32_t block, const Box& box, float squared_mm2) noexcept {
  of_block_.clear();
  for (std::uint32_t cell = tree_.first_of(block); cell < tree_.end_of(block); ++cell) {
    of_block_.append(EightPoints::of(tree_.cells()[cell]), kAll);
  }
  const BoxGaps gaps(box);
  const FloatLanes limit = lanes::splat(squared_mm2);
  Reach reach{squared_mm2};
  bool fits = true;
  const auto reach_of = [&]() noexcept { return reach; };
  tree_.visit_beyond(block, box, reach_of, [&](std::uint32_t cell) noexcept {
    if (!of_block_.has_room()) {
      fits = false;
      reach.squared_mm2 = kNever;
      return;
    }
    const EightPoints points = EightPoints::of(tree_.cells()[cell]);
    of_block_.append(points, bits(gaps.squared_mm2(points) <= limit));
  });
  return fits;
}

void NearPoints::narrow(const BoxGaps& gaps, Ring ring, std::size_t from, std::size_t to) noexcept {
  const NearView points = of_block_.view();
  const FloatLanes above = lanes::splat(ring.above_mm2);
  const FloatLanes upto = lanes::splat(ring.upto_mm2);
  PointList list = of_cell_;
  for (std::size_t i = from; i < std::min(to, points.count); i += kLanes) {
    const EightPoints eight = EightPoints::of(points, i);
    const FloatLanes squared = gaps.squared_mm2(eight);
    list.append(eight, bits((above < squared) & (squared <= upto)));
  }
  of_cell_ = list;
}

NearView NearPoints::others_of(std::uint32_t at, const Box& box, Ring ring) noexcept {
  const std::size_t own = at % kLanes * kLanes;
  const BoxGaps gaps(box);
  const NearView points = of_block_.view();
  const FloatLanes above = lanes::splat(ring.above_mm2);
  const FloatLanes upto = lanes::splat(ring.upto_mm2);
  PointList list = of_cell_;
  list.clear();
  for (std::size_t i = own == 0 ? kLanes : 0; i < points.count;) {
    const EightPoints eight = EightPoints::of(points, i);
    const FloatLanes squared = gaps.squared_mm2(eight);
    list.append_places(eight, bits((above < squared) & (squared <= upto)));
    i += i + kLanes == own ? 2 * kLanes : kLanes;
  }
  of_cell_ = list;
  return of_cell_.view();
}

NearView NearPoints::all_of(std::uint32_t at, const Box& box, float squared_mm2) noexcept {
  const std::size_t own = at % kLanes * kLanes;
  const BoxGaps gaps(box);
  const Ring ring{kNever, squared_mm2};
  of_cell_.clear();
  narrow(gaps, ring, own, own + kLanes);
  narrow(gaps, ring, 0, own);
  narrow(gaps, ring, own + kLanes, kCapacity);
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
