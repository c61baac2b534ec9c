// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "dseam/hal/can_bus.hpp"

namespace dseam::hal::candump {

/// One line without its end: `(0000000012.345678) can0 125##1...` (FD) or `can0 120#0102`
/// (classic). `stamp_ns` counts from whatever the log says; candump itself takes the wall clock.
[[nodiscard]] std::string to_line(const CanFrame& frame, std::string_view interface);

/// Errors:  kBadData: not a candump line, or not a frame that CAN has.
[[nodiscard]] Result<CanFrame> from_line(std::string_view line);

}  // namespace dseam::hal::candump
