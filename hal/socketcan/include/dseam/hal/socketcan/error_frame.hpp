// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>

#include <cstdint>
#include <optional>

#include "dseam/hal/can_bus.hpp"

namespace dseam::hal::socketcan {

/// Error frames by what they report; one frame may report several things.
struct ErrorCounts {
  std::uint64_t tx_timeout = 0;
  std::uint64_t lost_arbitration = 0;
  std::uint64_t controller = 0;
  std::uint64_t controller_overflow = 0;  ///< Of the controller's own buffers.
  std::uint64_t protocol = 0;
  std::uint64_t transceiver = 0;
  std::uint64_t no_ack = 0;
  std::uint64_t bus_off = 0;
  std::uint64_t bus_error = 0;
  std::uint64_t restarted = 0;
};

/// Counts what `frame` reports; the new state of the controller where it names one.
///
/// Source:  linux/can/error.h.
std::optional<BusState> count_error(const can_frame& frame, ErrorCounts& counts) noexcept;

}  // namespace dseam::hal::socketcan
