// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dseam::link {

/// One CAN frame as the weld link sees it: 11-bit identifier, classic or FD.
/// `hal/bus/link_port.hpp` carries it to and from a CanBus.
struct Frame {
  static constexpr std::size_t kMaxSizeBytes = 64;

  std::uint32_t id = 0;
  bool fd = false;
  std::uint8_t size_bytes = 0;
  std::array<std::byte, kMaxSizeBytes> data{};

  [[nodiscard]] std::span<std::byte> bytes() noexcept { return {data.data(), size_bytes}; }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    return {data.data(), size_bytes};
  }
};

}  // namespace dseam::link
