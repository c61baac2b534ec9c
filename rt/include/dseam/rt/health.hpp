// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/hal/can_bus.hpp"
#include "dseam/link/sender.hpp"
#include "dseam/rt/fault.hpp"
#include "dseam/rt/session_machine.hpp"

namespace dseam::rt {

/// Everything that can be counted, in one snapshot of one cycle. Counters only rise.
struct Health {
  std::int64_t now_ns = 0;
  SessionState state = SessionState::kIdle;
  Fault fault = Fault::kNone;  ///< The latched one.
  link::Fault link_fault = link::Fault::kNone;
  Fault robot_fault = Fault::kNone;  ///< What the robot says of itself now, armed or not.
  hal::BusState bus = hal::BusState::kDown;
  bool arc_permitted = false;
  bool arc_on = false;  ///< As the robot reports it.
  std::uint64_t cycles = 0;
  std::uint64_t skipped = 0;  ///< Periods that were left out.
  std::uint64_t overruns = 0;
  std::uint64_t faults = 0;
  std::uint64_t refused = 0;  ///< Orders that the state did not allow.
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_dropped = 0;    ///< Found no room on the bus; sent anew by the protocol.
  std::uint64_t receive_full = 0;      ///< Cycles that left frames unread for the next one.
  std::uint64_t receive_overflow = 0;  ///< Frames lost before we could read them.
  std::uint64_t bus_warnings = 0;      ///< Cycles with the controller in warning or passive.
};

}  // namespace dseam::rt
