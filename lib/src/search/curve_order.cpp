// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/curve_order.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "dseam/base/lanes.hpp"

namespace dseam::search {
namespace {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::kLanes;
using lanes::load;
using lanes::shift_left;
using lanes::splat;

constexpr int kBitsPerAxis = 10;
constexpr float kLastCell = 1023.0F;
constexpr std::size_t kMaxRefinements = 24;
constexpr std::size_t kDigits = 3;
constexpr std::uint32_t kBitsPerDigit = kBitsPerAxis;
constexpr std::uint32_t kPlacesPerDigit = 1U << kBitsPerDigit;
static_assert(kCurveCounters == kDigits * kPlacesPerDigit);
constexpr std::size_t kSmallRun = 96;  // Below this an insertion sort beats clearing the counters.

struct Grid {
  geometry::Vec3f low;
  float cells_per_mm;  // 0 when all points are identical.
};

Grid grid_over(const cloud::CloudView& cloud, std::span<const CurvePlace> places) noexcept {
  geometry::Vec3f low = cloud[places.front().index];
  geometry::Vec3f high = low;
  for (const CurvePlace& place : places) {
    const geometry::Vec3f p = cloud[place.index];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const float extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  // An extent so small that its inverse overflows is as good as none.
  const bool is_point = !(extent > kLastCell * 1.0e-37F);
  return {low, is_point ? 0.0F : kLastCell / extent};
}

struct Axes {
  IntLanes x, y, z;
};

IntLanes is_set(const IntLanes& axis, std::int32_t bit) noexcept {
  return (axis & splat(bit)) == splat(bit);
}

// The inverse undo of Skilling's transform for one axis and one bit.
template <std::int32_t kBit>
[[gnu::always_inline]] inline void undo(IntLanes& first, IntLanes& axis) noexcept {
  const IntLanes set = is_set(axis, kBit);
  const IntLanes swapped = (first ^ axis) & splat(kBit - 1);
  axis = axis ^ select(set, splat(0), swapped);
  first = first ^ select(set, splat(kBit - 1), swapped);
}
template <std::int32_t kBit>
[[gnu::always_inline]] inline void undo(Axes& a) noexcept {
  a.x = a.x ^ (is_set(a.x, kBit) & splat(kBit - 1));
  undo<kBit>(a.x, a.y);
  undo<kBit>(a.x, a.z);
}

// Written out for each bit, so that no constant is made at run time.
template <int... kBelowTop>
[[gnu::always_inline]] inline Axes to_hilbert(Axes a,
                                              std::integer_sequence<int, kBelowTop...>) noexcept {
  constexpr std::int32_t kTop = 1 << (kBitsPerAxis - 1);
  (undo<(kTop >> kBelowTop)>(a), ...);
  a.y = a.y ^ a.x;
  a.z = a.z ^ a.y;
  IntLanes gray = splat(0);
  ((gray = gray ^ (is_set(a.z, kTop >> kBelowTop) & splat((kTop >> kBelowTop) - 1))), ...);
  return {a.x ^ gray, a.y ^ gray, a.z ^ gray};
}
Axes to_hilbert(const Axes& a) noexcept {
  return to_hilbert(a, std::make_integer_sequence<int, kBitsPerAxis - 1>{});
}

// Ten bits with two empty places before each.
IntLanes spread(IntLanes a) noexcept {
  a = (a | shift_left<16>(a)) & splat(0x030000FF);
  a = (a | shift_left<8>(a)) & splat(0x0300F00F);
  a = (a | shift_left<4>(a)) & splat(0x030C30C3);
  return (a | shift_left<2>(a)) & splat(0x09249249);
}

IntLanes cell_of(const float* coordinate, float low, float cells_per_mm) noexcept {
  const FloatLanes scaled = (load(coordinate) - splat(low)) * splat(cells_per_mm);
  return to_int(min(scaled, splat(kLastCell)));
}

// `to` may be where `places` are.
void key_eight(const cloud::CloudView& cloud, const Grid& grid, std::span<const CurvePlace> places,
               CurvePlace* to) noexcept {
  alignas(32) float x[kLanes];
  alignas(32) float y[kLanes];
  alignas(32) float z[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t index = places[std::min(i, places.size() - 1)].index;
    x[i] = cloud.x[index];
    y[i] = cloud.y[index];
    z[i] = cloud.z[index];
  }
  const Axes axes = to_hilbert({cell_of(x, grid.low.x, grid.cells_per_mm),
                                cell_of(y, grid.low.y, grid.cells_per_mm),
                                cell_of(z, grid.low.z, grid.cells_per_mm)});
  alignas(32) std::int32_t keys[kLanes];
  store(shift_left<2>(spread(axes.x)) | shift_left<1>(spread(axes.y)) | spread(axes.z), keys);
  for (std::size_t i = 0; i < places.size(); ++i) {
    to[i] = {static_cast<std::uint32_t>(keys[i]), places[i].index};
  }
}

void key_all(const cloud::CloudView& cloud, const Grid& grid, std::span<const CurvePlace> places,
             CurvePlace* to) noexcept {
  for (std::size_t i = 0; i < places.size(); i += kLanes) {
    key_eight(cloud, grid, places.subspan(i, std::min(kLanes, places.size() - i)), to + i);
  }
}

void insertion_sort(std::span<CurvePlace> places) noexcept {
  for (std::size_t i = 1; i < places.size(); ++i) {
    const CurvePlace moved = places[i];
    std::size_t to = i;
    for (; to > 0 && places[to - 1].key > moved.key; --to) {
      places[to] = places[to - 1];
    }
    places[to] = moved;
  }
}

std::uint32_t digit_of(std::uint32_t key, std::size_t digit) noexcept {
  return (key >> (kBitsPerDigit * digit)) % kPlacesPerDigit;
}

void count_digits(std::span<const CurvePlace> places, std::span<std::uint32_t> counters) noexcept {
  std::fill(counters.begin(), counters.end(), 0U);
  for (const CurvePlace& place : places) {
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
      ++counters[digit * kPlacesPerDigit + digit_of(place.key, digit)];
    }
  }
}

// Three stable passes of ten bits: what was in `from` ends in `to`.
void radix_sort(std::span<CurvePlace> from, std::span<CurvePlace> to,
                std::span<std::uint32_t> counters) noexcept {
  count_digits(from, counters);
  for (std::size_t digit = 0; digit < kDigits; ++digit) {
    const std::span<std::uint32_t> begin =
        counters.subspan(digit * kPlacesPerDigit, kPlacesPerDigit);
    std::uint32_t sum = 0;
    for (std::uint32_t& count : begin) {
      sum += std::exchange(count, sum);
    }
    for (const CurvePlace& place : from) {
      to[begin[digit_of(place.key, digit)]++] = place;
    }
    std::swap(from, to);
  }
}

void sort_over_grid(const cloud::CloudView& cloud, const Grid& grid, std::span<CurvePlace> places,
                    std::span<CurvePlace> spare, std::span<std::uint32_t> counters) noexcept {
  if (places.size() <= kSmallRun) {
    key_all(cloud, grid, places, places.data());
    insertion_sort(places);
  } else {
    key_all(cloud, grid, places, spare.data());
    radix_sort(spare.first(places.size()), places, counters);
  }
}

std::size_t run_length(std::span<const CurvePlace> places) noexcept {
  std::size_t length = 1;
  while (length < places.size() && places[length].key == places[0].key) {
    ++length;
  }
  return length;
}

}  // namespace

void sort_along_curve(const cloud::CloudView& cloud, std::size_t max_in_cell,
                      std::span<CurvePlace> places, std::span<CurvePlace> spare,
                      std::span<std::uint32_t> counters) noexcept {
  if (places.empty()) {
    return;
  }
  sort_over_grid(cloud, grid_over(cloud, places), places, spare, counters);
  // Ends of the runs being refined, innermost last; a run's own runs are looked at next.
  std::array<std::size_t, kMaxRefinements> ends;
  std::size_t depth = 0;
  ends[0] = places.size();
  for (std::size_t at = 0; at < places.size();) {
    while (at == ends[depth]) {
      --depth;
    }
    const std::span<CurvePlace> rest = places.subspan(at, ends[depth] - at);
    const std::span<CurvePlace> run = rest.first(run_length(rest));
    const bool crowded = run.size() > max_in_cell && depth + 1 < kMaxRefinements;
    const Grid grid = crowded ? grid_over(cloud, run) : Grid{};
    if (grid.cells_per_mm > 0.0F) {
      sort_over_grid(cloud, grid, run, spare, counters);
      ends[++depth] = at + run.size();
    } else {
      at += run.size();
    }
  }
}

}  // namespace dseam::search
