// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dseam/base/lanes.hpp"

namespace dseam::lanes {

/// Moves the lanes whose bit is set to the front, in their order.
///
/// Shape:   store() writes kLanes places; what follows the packed ones means nothing.
class LanePacker {
 public:
#if defined(__AVX2__)
  [[gnu::always_inline]] explicit LanePacker(std::uint32_t bits) noexcept
      : order_(splat(static_cast<std::int32_t>(kOrders[bits])).low >>
               IntPart{0, 4, 8, 12, 16, 20, 24, 28}) {}
  [[gnu::always_inline]] void store(const FloatLanes& lanes, float* to) const noexcept {
    lanes::store(FloatLanes{__builtin_ia32_permvarsf256(lanes.low, order_)}, to);
  }
  [[gnu::always_inline]] void store(const IntLanes& lanes, std::uint32_t* to) const noexcept {
    lanes::store(IntLanes{__builtin_ia32_permvarsi256(lanes.low, order_)}, to);
  }

 private:
  // For each set of bits the lanes in it, four bits a lane.
  static constexpr std::array<std::uint32_t, 256> kOrders = [] {
    std::array<std::uint32_t, 256> orders{};
    for (std::uint32_t bits = 0; bits < orders.size(); ++bits) {
      for (std::uint32_t lane = 0, place = 0; lane < kLanes; ++lane) {
        orders[bits] |= (bits >> lane & 1U) * (lane << place);
        place += 4 * (bits >> lane & 1U);
      }
    }
    return orders;
  }();

  IntPart order_;
#else
  explicit LanePacker(std::uint32_t bits) noexcept : bits_(bits) {}
  template <typename Part, typename E>
  [[gnu::always_inline]] void store(const Lanes<Part>& lanes, E* to) const noexcept {
    E each[kLanes];
    lanes::store(lanes, each);
    std::size_t place = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      to[place] = each[lane];
      place += bits_ >> lane & 1U;
    }
  }

 private:
  std::uint32_t bits_;
#endif
};

}  // namespace dseam::lanes
