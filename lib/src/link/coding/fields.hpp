// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "dseam/link/frame.hpp"

namespace dseam::link {

/// Little-endian fields of a frame's payload; `at` is the first byte.
template <typename Word>
constexpr void put(Frame& frame, std::size_t at, Word value,
                   std::size_t size_bytes = sizeof(Word)) noexcept {
  auto rest = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < size_bytes; ++i, rest >>= 8U) {
    frame.data[at + i] = static_cast<std::byte>(rest & 0xFFU);
  }
}

template <typename Word>
[[nodiscard]] constexpr Word get(const Frame& frame, std::size_t at,
                                 std::size_t size_bytes = sizeof(Word)) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = size_bytes; i-- > 0;) {
    value = (value << 8U) | std::to_integer<std::uint64_t>(frame.data[at + i]);
  }
  return static_cast<Word>(value);
}

/// 48-bit times.
inline constexpr std::size_t kTimeBytes = 6;

/// Puts `value / scale`, rounded. False, and nothing put, when it does not fit or is not a number.
template <typename Word>
[[nodiscard]] bool put_scaled(Frame& frame, std::size_t at, double value, double scale) noexcept {
  const double counts = value / scale;
  constexpr auto kLow = static_cast<double>(std::numeric_limits<Word>::min());
  constexpr auto kHigh = static_cast<double>(std::numeric_limits<Word>::max());
  if (!(counts > kLow - 0.5 && counts < kHigh + 0.5)) {
    return false;
  }
  put(frame, at, static_cast<Word>(static_cast<std::int64_t>(counts + (counts < 0 ? -0.5 : 0.5))));
  return true;
}

template <typename Word>
[[nodiscard]] double get_scaled(const Frame& frame, std::size_t at, double scale) noexcept {
  return static_cast<double>(get<Word>(frame, at)) * scale;
}

}  // namespace dseam::link
