// SPDX-License-Identifier: Apache-2.0
#include "rt/session/cell/faults.hpp"

namespace dseam::test {
namespace {

using rt::Fault;
using Cell = VirtualCell;
constexpr std::int64_t kMs = 1'000'000;

void nothing(Cell&) {}

link::Status stranger(const Cell& cell, std::uint32_t session_offset, std::uint16_t ack_offset) {
  link::Status status = cell.sender().status();
  status.session += session_offset;
  status.ack_seq = static_cast<std::uint16_t>(status.ack_seq + ack_offset);
  status.exec_seq = static_cast<std::uint16_t>(status.exec_seq + ack_offset);
  return status;
}

template <typename T>
auto set(T link_to, auto value) {
  return [link_to, value](Cell& cell) { cell.bus.trouble.*link_to = value; };
}

template <typename T>
auto robot(T member, auto value) {
  return [member, value](Cell& cell) { cell.robot_trouble.*member = value; };
}

using B = BusTrouble;
using R = RobotTrouble;

}  // namespace

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kinds = {
      {"12 bus takes nothing for long",
       set(&B::blocked, true),
       set(&B::blocked, false),
       {Fault::kTxBlocked, Fault::kPeerStopped, Fault::kDataStale, Fault::kStreamStopped}},
      {"12 bus takes nothing for a moment",
       set(&B::blocked, true),
       set(&B::blocked, false),
       {Fault::kNone},
       8 * kMs},
      {"13 bus-off",
       set(&B::state, hal::BusState::kBusOff),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusOff}},
      {"14 error-passive",
       set(&B::state, hal::BusState::kErrorPassive),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusNotActive, Fault::kNone}},
      {"14 error-warning",
       set(&B::state, hal::BusState::kErrorWarning),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kNone}},
      {"15 interface down",
       set(&B::state, hal::BusState::kDown),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusOff}},
      {"16 bit flips",
       set(&B::corrupt, 0.5),
       set(&B::corrupt, 0.0),
       {Fault::kLinkLost, Fault::kDataStale, Fault::kPeerStopped, Fault::kNone}},
      {"16 rare bit flips",
       set(&B::corrupt, 0.01),
       set(&B::corrupt, 0.0),
       {Fault::kLinkLost, Fault::kDataStale, Fault::kPeerStopped, Fault::kNone}},
      {"17 loss",
       set(&B::lose, 0.4),
       set(&B::lose, 0.0),
       {Fault::kLinkLost, Fault::kDataStale, Fault::kPeerStopped, Fault::kStreamStopped,
        Fault::kNone}},
      {"17 repetition",
       set(&B::duplicate, 0.3),
       set(&B::duplicate, 0.0),
       {Fault::kLinkLost, Fault::kPeerStopped, Fault::kNone}},
      {"17 reordering",
       set(&B::reorder, 0.3),
       set(&B::reorder, 0.0),
       {Fault::kLinkLost, Fault::kPeerStopped, Fault::kDataStale, Fault::kNone}},
      {"17 delay",
       set(&B::extra_delay_ns, 60 * kMs),
       set(&B::extra_delay_ns, 0),
       {Fault::kDataStale, Fault::kPeerStopped, Fault::kLinkLost}},
      {"19 flood",
       set(&B::flood, 200U),
       set(&B::flood, 0U),
       {Fault::kDataStale, Fault::kPeerStopped, Fault::kLinkLost, Fault::kNone}},
      {"21 robot silent",
       robot(&R::silent, true),
       robot(&R::silent, false),
       {Fault::kDataStale, Fault::kLinkLost}},
      {"21 cable cut",
       set(&B::cut, true),
       set(&B::cut, false),
       {Fault::kDataStale, Fault::kPeerStopped, Fault::kLinkLost}},
      {"21 another session answers",
       [](Cell& c) { c.robot_trouble.impostor = stranger(c, 77, 0); },
       [](Cell& c) { c.robot_trouble.impostor.reset(); },
       {Fault::kDataStale, Fault::kLinkLost, Fault::kPeerStopped}},
      {"21 acknowledges what was not sent",
       [](Cell& c) { c.robot_trouble.impostor = stranger(c, 0, 9000); },
       [](Cell& c) { c.robot_trouble.impostor.reset(); },
       {Fault::kDataStale, Fault::kLinkLost, Fault::kPeerStopped, Fault::kStreamStopped}},
      {"23 tracking error",
       robot(&R::behind_mm, 6.0),
       robot(&R::behind_mm, 0.0),
       {Fault::kTrackingError}},
      {"gate: beside the path",
       robot(&R::aside_mm, 2.5),
       robot(&R::aside_mm, 0.0),
       {Fault::kOutsideCorridor}},
      {"gate: outside the workspace",
       robot(&R::aside_mm, 3500.0),
       robot(&R::aside_mm, 0.0),
       {Fault::kTrackingError, Fault::kOutsideWorkspace}},
      {"gate: too fast",
       robot(&R::speed_factor, 2.0),
       robot(&R::speed_factor, 1.0),
       {Fault::kSpeedOutOfWindow}},
      {"gate: too slow",
       robot(&R::speed_factor, 0.1),
       robot(&R::speed_factor, 1.0),
       {Fault::kSpeedOutOfWindow}},
      {"30 torch stands",
       robot(&R::frozen, true),
       robot(&R::frozen, false),
       {Fault::kStandstill, Fault::kTrackingError, Fault::kOutsideCorridor,
        Fault::kSpeedOutOfWindow},
       800 * kMs},
      {"gate: seam in doubt",
       [](Cell& c) { c.inputs.confidence = 0.2; },
       [](Cell& c) { c.inputs.confidence = 1.0; },
       {Fault::kConfidenceLow}},
      {"24 one overrun", [](Cell& c) { c.stall_ns = 3 * kMs; }, nothing, {Fault::kNone}},
      {"24 overruns", [](Cell& c) { c.stall_ns = 2 * kMs; }, nothing, {Fault::kNone}},
      {"25 suspended",
       [](Cell& c) { c.stall_ns = 3'600'000 * kMs / 1000; },
       nothing,
       {Fault::kClockJump, Fault::kDataStale, Fault::kLinkLost, Fault::kPeerStopped}},
      {"26 vision silent",
       [](Cell& c) { c.inputs.vision_silent_ns = 500 * kMs; },
       [](Cell& c) { c.inputs.vision_silent_ns = 0; },
       {Fault::kVisionSilent}},
      {"27 privilege lost",
       [](Cell& c) { c.inputs.real_time = false; },
       [](Cell& c) { c.inputs.real_time = true; },
       {Fault::kPrivilege}},
      {"29 signal",
       [](Cell& c) { c.session.trip(Fault::kOperator); },
       nothing,
       {Fault::kOperator}}};
  return kinds;
}

}  // namespace dseam::test
