// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/link/sender.hpp"

namespace dseam::link {

/// One weld as the host orders it.
struct WeldOrder {
  std::uint32_t session = 0;  ///< New for each weld; see Sender::connect().
  std::uint16_t trajectory = 1;
  trajectory::SetPointView points;
  bool weld_permit = false;  ///< Off: the path is driven with the arc off.
};

enum class WeldProgress : std::uint8_t { kUnderWay, kDone, kFailed };

/// Gives the next order once the robot has followed the one before: connect, arm, load, start.
/// One call a cycle, before the sender's poll(). kFailed: see fault().
WeldProgress give_next_order(Sender& sender, const WeldOrder& weld, std::int64_t now_ns) noexcept;

}  // namespace dseam::link
