// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace dseam::link {

/// CRC-16/CCITT-FALSE (polynomial 0x1021, not reflected); `start` chains calls.
///
/// Source:  AUTOSAR FO, Specification of CRC Routines, Crc_CalculateCRC16.
[[nodiscard]] std::uint16_t crc16_ccitt(std::span<const std::byte> data,
                                        std::uint16_t start = 0xFFFF) noexcept;

/// CRC-8 with polynomial 0x2F; `start` chains calls, the final inversion is undone and done again.
///
/// Source:  AUTOSAR FO, Specification of CRC Routines, Crc_CalculateCRC8H2F.
[[nodiscard]] std::uint8_t crc8_h2f(std::span<const std::byte> data,
                                    std::uint8_t start = 0x00) noexcept;

/// CRC-32 of IEEE 802.3 (as zlib's); `start` chains calls.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> data,
                                  std::uint32_t start = 0) noexcept;

}  // namespace dseam::link
