// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "dseam/search/near_points.hpp"
#include "dseam/search/query_cell.hpp"
#include "least.hpp"
#include "nearest_list.hpp"

namespace dseam::search {

/// A squared distance with an index below it, as the bits of a double: these order as the bits do,
/// so one comparison goes by distance and then by index. No arithmetic is done with them.
struct KeyPart {
  typedef double Bits __attribute__((vector_size(lanes::kPartLanes * sizeof(float))));
  Bits bits;

  [[gnu::always_inline]] friend KeyPart min(const KeyPart& a, const KeyPart& b) noexcept {
    return {a.bits < b.bits ? a.bits : b.bits};
  }
  [[gnu::always_inline]] friend KeyPart max(const KeyPart& a, const KeyPart& b) noexcept {
    return {a.bits > b.bits ? a.bits : b.bits};
  }
};
static_assert(std::endian::native == std::endian::little && sizeof(Neighbour) == sizeof(double));

/// The keys of eight points.
struct Keys {
  static constexpr std::size_t kParts = 2 * kLanes / lanes::kPartLanes;
  std::array<KeyPart, kParts> parts;

  [[gnu::always_inline]] static Keys of(const FloatLanes& squared, const IntLanes& index) noexcept {
    std::array<lanes::IntPart, kParts / 2> high;
    std::array<lanes::IntPart, kParts / 2> low;
    std::memcpy(&high, &squared, sizeof high);
    std::memcpy(&low, &index, sizeof low);
    Keys keys;
    for (std::size_t i = 0; i < kParts; i += 2) {
#if defined(__AVX__)
      const auto front = __builtin_shufflevector(low[i / 2], high[i / 2], 0, 8, 1, 9, 4, 12, 5, 13);
      const auto back =
          __builtin_shufflevector(low[i / 2], high[i / 2], 2, 10, 3, 11, 6, 14, 7, 15);
#else
      const auto front = __builtin_shufflevector(low[i / 2], high[i / 2], 0, 4, 1, 5);
      const auto back = __builtin_shufflevector(low[i / 2], high[i / 2], 2, 6, 3, 7);
#endif
      std::memcpy(&keys.parts[i], &front, sizeof front);
      std::memcpy(&keys.parts[i + 1], &back, sizeof back);
    }
    return keys;
  }
  [[gnu::always_inline, nodiscard]] FloatLanes squared_mm2() const noexcept {
    std::array<lanes::FloatPart, kParts / 2> squared;
    for (std::size_t i = 0; i < kParts; i += 2) {
      lanes::FloatPart front;
      lanes::FloatPart back;
      std::memcpy(&front, &parts[i], sizeof front);
      std::memcpy(&back, &parts[i + 1], sizeof back);
#if defined(__AVX__)
      squared[i / 2] = __builtin_shufflevector(front, back, 1, 3, 9, 11, 5, 7, 13, 15);
#else
      squared[i / 2] = __builtin_shufflevector(front, back, 1, 3, 5, 7);
#endif
    }
    FloatLanes all;
    std::memcpy(&all, &squared, sizeof all);
    return all;
  }
  /// Where in the parts' memory a lane's key lies.
  [[nodiscard]] static constexpr std::size_t place_of(std::size_t lane) noexcept {
#if defined(__AVX__)
    constexpr std::size_t kPlaces[kLanes] = {0, 1, 4, 5, 2, 3, 6, 7};
    return kPlaces[lane];
#else
    return lane;
#endif
  }
};

/// The kRoom nearest neighbours of each of eight points, in rising order of distance and then of
/// index.
template <std::size_t kRoom>
class LeastNeighbours {
 public:
  static constexpr std::size_t kMost = kRoom;
  static constexpr bool kIndices = true;

  LeastNeighbours() noexcept { clear(); }
  void clear() noexcept {
    const Keys none = Keys::of(never(), nobody());
    for (std::size_t part = 0; part < Keys::kParts; ++part) {
      of_[part].least.fill(none.parts[part]);
    }
  }

  void insert_own(const QueryCell& query, const Cell& own) noexcept {
    for (std::size_t i = 0; i < kLanes; i += 4) {
      const auto key = [&](std::size_t j) noexcept {
        const IntLanes self = lanes::is_lane(j);
        return Keys::of(
            select(self, never(), query.squared_distances(own, j)),
            select(self, nobody(), lanes::splat(static_cast<std::int32_t>(own.index[j]))));
      };
      insert_four(of_, key(i), key(i + 1), key(i + 2), key(i + 3));
    }
  }
  void insert_cell(const QueryCell& query, const Cell& cell) noexcept {
    insert(query, cell.x, cell.y, cell.z, cell.index, kLanes);
  }
  void insert_all(const QueryCell& query, const NearView& points) noexcept {
    insert(query, points.x, points.y, points.z, points.index, points.count);
  }
  void set(std::size_t lane, std::size_t place, const Neighbour& its) noexcept {
    constexpr std::size_t kInPart = kLanes / Keys::kParts;
    const std::size_t at = Keys::place_of(lane);
    of_[at / kInPart].least[place].bits[at % kInPart] = std::bit_cast<double>(its);
  }
  /// What another list has of one of the eight.
  void take(const LeastNeighbours& other, std::size_t lane) noexcept {
    for (std::size_t i = 0; i < kRoom; ++i) {
      set(lane, i, other(lane, i));
    }
  }

  [[nodiscard]] FloatLanes squared_mm2(std::size_t place) const noexcept {
    Keys keys;
    for (std::size_t part = 0; part < Keys::kParts; ++part) {
      keys.parts[part] = of_[part].least[place];
    }
    return keys.squared_mm2();
  }
  /// Of one of the eight.
  [[nodiscard]] Neighbour operator()(std::size_t lane, std::size_t place) const noexcept {
    constexpr std::size_t kInPart = kLanes / Keys::kParts;
    const std::size_t at = Keys::place_of(lane);
    return std::bit_cast<Neighbour>(of_[at / kInPart].least[place].bits[at % kInPart]);
  }
  [[nodiscard]] Reach reach(std::size_t k) const noexcept {
    Reach reach{largest(squared_mm2(k - 1)), 0};
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Neighbour last = (*this)(lane, k - 1);
      const bool decides = last.squared_mm2 == reach.squared_mm2;
      reach.index = decides ? std::max(reach.index, last.index) : reach.index;
    }
    return reach;
  }
  [[nodiscard]] bool may_take(const QueryCell& query, const Box& box,
                              std::size_t k) const noexcept {
    return query.bits_within(box, squared_mm2(k - 1)) != 0;
  }

 private:
  using Lists = std::array<Least<KeyPart, kRoom>, Keys::kParts>;
  using Working = std::conditional_t<(kRoom <= 5), Lists, Lists&>;

  static FloatLanes never() noexcept {
    return lanes::splat(std::numeric_limits<float>::infinity());
  }
  static IntLanes nobody() noexcept { return lanes::splat(static_cast<std::int32_t>(kNoPoint)); }

  [[gnu::always_inline]] static void insert_four(Lists& lists, const Keys& a, const Keys& b,
                                                 const Keys& c, const Keys& d) noexcept {
    for (std::size_t part = 0; part < Keys::kParts; ++part) {
      lists[part].insert_four(a.parts[part], b.parts[part], c.parts[part], d.parts[part]);
    }
  }
  [[gnu::always_inline]] void insert(const QueryCell& eight, const float* x, const float* y,
                                     const float* z, const std::uint32_t* index,
                                     std::size_t count) noexcept {
    Working local = of_;
    const QueryCell query = eight;
    const auto key = [&](std::size_t i) noexcept {
      return Keys::of(query.squared_distances(x[i], y[i], z[i]),
                      lanes::splat(static_cast<std::int32_t>(index[i])));
    };
    for (std::size_t i = 0; i < count; i += 4) {
      insert_four(local, key(i), key(i + 1), key(i + 2), key(i + 3));
    }
    of_ = local;
  }

  Lists of_;
};

}  // namespace dseam::search
