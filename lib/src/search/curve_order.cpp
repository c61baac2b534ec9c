// SPDX-License-Identifier: Apache-2.0
#include "dseam/search/curve_order.hpp"

#include <algorithm>
#include <array>
#include <limits>
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
constexpr std::size_t kSmallRun = 192;  // Below this ranking beats clearing the counters.
constexpr std::size_t kFew = 32;

struct Grid {
  geometry::Vec3f low;
  float cells_per_mm;  // 0 when all points are identical.
};

struct EightPoints {
  FloatLanes x, y, z;
};

template <bool kAll>
EightPoints pick_eight(const cloud::CloudView& cloud, std::span<const CurvePlace> places) noexcept {
  alignas(32) float x[kLanes];
  alignas(32) float y[kLanes];
  alignas(32) float z[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::size_t index = places[kAll ? i : std::min(i, places.size() - 1)].index;
    x[i] = cloud.x[index];
    y[i] = cloud.y[index];
    z[i] = cloud.z[index];
  }
  return {load(x), load(y), load(z)};
}

// The first eight of `places`, the last of fewer repeated. Points that lie in the cloud side by
// side, as all do before the first sort, are not picked one by one.
EightPoints eight_at(const cloud::CloudView& cloud, std::span<const CurvePlace> places) noexcept {
  if (places.size() < kLanes) {
    return pick_eight<false>(cloud, places);
  }
  const std::size_t first = places[0].index;
  const bool side_by_side = places[kLanes - 1].index - first == kLanes - 1;
  return side_by_side
             ? EightPoints{load(&cloud.x[first]), load(&cloud.y[first]), load(&cloud.z[first])}
             : pick_eight<true>(cloud, places);
}

// `eight_from(i)` has the points from place `i` on.
template <typename EightFrom>
Grid grid_over(std::size_t size, const EightFrom& eight_from) noexcept {
  EightPoints low = eight_from(0);
  EightPoints high = low;
  for (std::size_t i = kLanes; i < size; i += kLanes) {
    const EightPoints p = eight_from(i);
    low = {min(low.x, p.x), min(low.y, p.y), min(low.z, p.z)};
    high = {max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)};
  }
  const geometry::Vec3f corner{least(low.x), least(low.y), least(low.z)};
  const float extent = std::max(
      {largest(high.x) - corner.x, largest(high.y) - corner.y, largest(high.z) - corner.z});
  // An extent so small that its inverse overflows is as good as none.
  const bool is_point = !(extent > kLastCell * 1.0e-37F);
  return {corner, is_point ? 0.0F : kLastCell / extent};
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
  // A bit of this is set where an odd number of those above it are in z.
  IntLanes gray = shift_right<1>(a.z);
  gray = gray ^ shift_right<1>(gray);
  gray = gray ^ shift_right<2>(gray);
  gray = gray ^ shift_right<4>(gray);
  gray = gray ^ shift_right<8>(gray);
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

IntLanes cell_of(const FloatLanes& coordinate, float low, float cells_per_mm) noexcept {
  const FloatLanes scaled = (coordinate - splat(low)) * splat(cells_per_mm);
  return to_int(min(scaled, splat(kLastCell)));
}

IntLanes keys_of(const Grid& grid, const EightPoints& p) noexcept {
  const Axes axes = to_hilbert({cell_of(p.x, grid.low.x, grid.cells_per_mm),
                                cell_of(p.y, grid.low.y, grid.cells_per_mm),
                                cell_of(p.z, grid.low.z, grid.cells_per_mm)});
  return shift_left<2>(spread(axes.x)) | shift_left<1>(spread(axes.y)) | spread(axes.z);
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

// Each to where as many lie before it as have lesser keys: eight at a time, and for few fewer steps
// than a sort takes, the same ones whatever the keys.
template <typename EightFrom>
void sort_by_rank(const Grid& grid, std::span<CurvePlace> places, CurvePlace* spare,
                  const EightFrom& eight_from) noexcept {
  alignas(32) std::int32_t keys[kSmallRun + kLanes];
  alignas(32) std::int32_t ranks[kSmallRun + kLanes];
  std::uint8_t equal_before[kSmallRun];
  const std::size_t size = places.size();
  for (std::size_t i = 0; i < size; i += kLanes) {
    store(keys_of(grid, eight_from(i)), &keys[i]);
  }
  std::fill_n(keys + size, kLanes, std::numeric_limits<std::int32_t>::max());
  for (std::size_t i = 0; i < size; i += kLanes) {
    const IntLanes own = load(&keys[i]);
    const auto is_less = [&](std::size_t j) noexcept { return splat(keys[j]) < own; };
    IntLanes rank = splat(0);  // A mask that is set counts as -1.
    for (std::size_t j = 0; j < size; j += 4) {
      rank = rank - is_less(j) - is_less(j + 1) - is_less(j + 2) - is_less(j + 3);
    }
    store(rank, &ranks[i]);
  }
  std::copy_n(places.begin(), size, spare);
  std::fill_n(equal_before, size, std::uint8_t{0});
  for (std::size_t i = 0; i < size; ++i) {
    const auto rank = static_cast<std::size_t>(ranks[i]);
    places[rank + equal_before[rank]++] = {static_cast<std::uint32_t>(keys[i]), spare[i].index};
  }
}

// False when all points are identical.
template <typename EightFrom>
bool sort_over_grid(std::span<CurvePlace> places, std::span<CurvePlace> spare,
                    std::span<std::uint32_t> counters, const EightFrom& eight_from) noexcept {
  const Grid grid = grid_over(places.size(), eight_from);
  if (!(grid.cells_per_mm > 0.0F)) {
    return false;
  }
  spare = spare.first(places.size());
  if (places.size() <= kSmallRun) {
    sort_by_rank(grid, places, spare.data(), eight_from);
    return true;
  }
  for (std::size_t i = 0; i < places.size(); i += kLanes) {
    alignas(32) std::int32_t keys[kLanes];
    store(keys_of(grid, eight_from(i)), keys);
    for (std::size_t j = 0; j < std::min(kLanes, places.size() - i); ++j) {
      spare[i + j] = {static_cast<std::uint32_t>(keys[j]), places[i + j].index};
    }
  }
  radix_sort(spare, places, counters);
  return true;
}

// Not inlined: beside each other the two frames of sort_by_rank would be too large for one stack.
[[gnu::noinline]] bool sort_few(const cloud::CloudView& cloud, std::span<CurvePlace> places,
                                std::span<CurvePlace> spare,
                                std::span<std::uint32_t> counters) noexcept {
  std::array<EightPoints, kFew / kLanes> picked{};  // Once for the grid and the keys.
  for (std::size_t i = 0; i < places.size(); i += kLanes) {
    picked[i / kLanes] = eight_at(cloud, places.subspan(i));
  }
  return sort_over_grid(places, spare, counters,
                        [&](std::size_t i) noexcept { return picked[i / kLanes]; });
}

bool sort_over_own_grid(const cloud::CloudView& cloud, std::span<CurvePlace> places,
                        std::span<CurvePlace> spare, std::span<std::uint32_t> counters) noexcept {
  if (places.size() <= kFew) {
    return sort_few(cloud, places, spare, counters);
  }
  return sort_over_grid(places, spare, counters,
                        [&](std::size_t i) noexcept { return eight_at(cloud, places.subspan(i)); });
}

// How many places the first key has, when they are more than `few`; else 1.
std::size_t crowd_at(std::span<const CurvePlace> places, std::size_t few) noexcept {
  std::size_t length = 1;
  if (places.size() > few && places[few].key == places[0].key) {
    for (length = few + 1; length < places.size() && places[length].key == places[0].key;) {
      ++length;
    }
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
  sort_over_own_grid(cloud, places, spare, counters);
  // Ends of the crowds being refined, innermost last; a crowd's own crowds are looked at next.
  std::array<std::size_t, kMaxRefinements> ends;
  std::size_t depth = 0;
  ends[0] = places.size();
  for (std::size_t at = 0; at < places.size();) {
    while (at == ends[depth]) {
      --depth;
    }
    const std::span<CurvePlace> rest = places.subspan(at, ends[depth] - at);
    const std::span<CurvePlace> run = rest.first(crowd_at(rest, max_in_cell));
    const bool crowded = run.size() > 1 && depth + 1 < kMaxRefinements;
    if (crowded && sort_over_own_grid(cloud, run, spare, counters)) {
      ends[++depth] = at + run.size();
    } else {
      at += run.size();
    }
  }
}

}  // namespace dseam::search
