// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace dseam::search {

/// The kRoom least of all values offered, in rising order and without a branch; each lane of a
/// vector for itself. `min` and `max` of T are found by its namespace.
template <typename T, std::size_t kRoom>
struct Least {
  std::array<T, kRoom> least;

  [[gnu::always_inline]] void insert(T value) noexcept {
    if constexpr (kRoom <= kShort) {
      insert_each(value, std::make_index_sequence<kRoom>{});
    } else {
      for (T& kept : least) {
        order(kept, value);
      }
    }
  }
  /// The same, with less work than one after the other where the list is the paper's five.
  [[gnu::always_inline]] void insert_four(T a, T b, T c, T d) noexcept {
    if constexpr (kRoom == 5) {
      order(a, b);
      order(c, d);
      order(a, c);
      order(b, d);
      order(b, c);
      merge(a, b, c, d);
    } else {
      insert(a);
      insert(b);
      insert(c);
      insert(d);
    }
  }

 private:
  [[gnu::always_inline]] static void order(T& low, T& high) noexcept {
    const T least_of_both = min(low, high);
    high = max(low, high);
    low = least_of_both;
  }
  // The lesser of each pair from opposite ends are the least five of the nine: they rise, then
  // fall, and five exchanges order them.
  [[gnu::always_inline]] void merge(const T& a, const T& b, const T& c, const T& d) noexcept {
    least[1] = min(least[1], d);
    least[2] = min(least[2], c);
    least[3] = min(least[3], b);
    least[4] = min(least[4], a);
    order(least[0], least[4]);
    order(least[1], least[3]);
    order(least[2], least[4]);
    order(least[1], least[2]);
    order(least[3], least[4]);
  }
  static constexpr std::size_t kShort = 10;
  // Written out, so that short lists stay in registers; long ones would fill the stack where a
  // vector has none.
  template <std::size_t... kPlaces>
  [[gnu::always_inline]] void insert_each(T value, std::index_sequence<kPlaces...>) noexcept {
    (order(least[kPlaces], value), ...);
  }
};

}  // namespace dseam::search
