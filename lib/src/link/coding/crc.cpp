// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/crc.hpp"

#include <array>

namespace dseam::link {
namespace {

template <typename Word>
using Table = std::array<Word, 256>;

/// Most significant bit first.
template <typename Word, Word kPolynomial>
consteval Table<Word> forward_table() {
  constexpr unsigned kBits = sizeof(Word) * 8;
  Table<Word> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    auto value = static_cast<Word>(i << (kBits - 8U));
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = ((value >> (kBits - 1U)) & 1U) != 0;
      value = static_cast<Word>((value << 1U) ^ (carry ? kPolynomial : Word{0}));
    }
    table[i] = value;
  }
  return table;
}

consteval Table<std::uint32_t> reflected_table() {
  Table<std::uint32_t> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    table[i] = value;
  }
  return table;
}

constexpr auto kTable16 = forward_table<std::uint16_t, 0x1021>();
constexpr auto kTable8 = forward_table<std::uint8_t, 0x2F>();
constexpr auto kTable32 = reflected_table();

}  // namespace

std::uint16_t crc16_ccitt(std::span<const std::byte> data, std::uint16_t start) noexcept {
  std::uint16_t crc = start;
  for (const std::byte byte : data) {
    const auto index = static_cast<std::uint8_t>((crc >> 8U) ^ std::to_integer<unsigned>(byte));
    crc = static_cast<std::uint16_t>((crc << 8U) ^ kTable16[index]);
  }
  return crc;
}

std::uint8_t crc8_h2f(std::span<const std::byte> data, std::uint8_t start) noexcept {
  auto crc = static_cast<std::uint8_t>(~start);
  for (const std::byte byte : data) {
    crc = kTable8[crc ^ std::to_integer<std::uint8_t>(byte)];
  }
  return static_cast<std::uint8_t>(~crc);
}

std::uint32_t crc32(std::span<const std::byte> data, std::uint32_t start) noexcept {
  std::uint32_t crc = ~start;
  for (const std::byte byte : data) {
    crc = (crc >> 8U) ^ kTable32[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~crc;
}

}  // namespace dseam::link
