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

auto camera(hal::fake::DeviceFault fault) {
  return [fault](Cell& cell) { cell.vision.play(fault); };
}

template <typename T>
auto health(T counter) {
  return [counter](const Cell& cell) { return cell.session.health().*counter; };
}

/// What both ends of the link counted.
template <typename S, typename R>
auto link_counts(S at_host, R at_robot) {
  return [at_host, at_robot](const Cell& cell) {
    return cell.sender().report().*at_host + cell.robot().report().*at_robot;
  };
}

auto verdicts(hal::CameraVerdict verdict) {
  return [verdict](const Cell& cell) { return cell.vision.counted(verdict); };
}

const link::RobotCondition kReady{.enabled = true};

void stall_three_times(Cell& cell) {
  for (int i = 0; i < 3; ++i) {
    cell.stall_ns = 2 * kMs;
    cell.run(4 * kMs);
  }
}

using B = BusTrouble;
using R = RobotTrouble;
using D = hal::fake::DeviceFault;
using V = hal::CameraVerdict;
using Sent = link::Sender::Report;
using Received = link::Receiver::Report;

}  // namespace

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kinds = {
      {"1 camera off", camera(D::kOff), camera(D::kNone), {Fault::kVisionSilent}},
      {"2 frames lost on their way", camera(D::kLost), camera(D::kNone), {Fault::kVisionSilent}},
      {"3 camera stuck", camera(D::kStuck), camera(D::kNone), {Fault::kVisionSilent}},
      {"4 garbage in the image", camera(D::kGarbage), camera(D::kNone), {Fault::kConfidenceLow}},
      {"5 frames cut off", camera(D::kTruncated), camera(D::kNone), {Fault::kVisionSilent}},
      {"6 frames too old", camera(D::kDelayed), camera(D::kNone), {Fault::kVisionSilent}},
      {"7 a quarter of the frames",
       camera(D::kSlow),
       camera(D::kNone),
       {Fault::kNone},
       300 * kMs,
       verdicts(V::kSilent)},
      {"8 camera unplugged", camera(D::kUnplugged), camera(D::kNone), {Fault::kVisionSilent}},
      {"9 camera's clock jumps",
       camera(D::kClockJump),
       camera(D::kNone),
       {Fault::kNone},
       300 * kMs,
       verdicts(V::kClockJump)},
      {"12 bus takes nothing for long",
       set(&B::blocked, true),
       set(&B::blocked, false),
       {Fault::kPeerStopped}},
      {"12 bus takes nothing for a moment",
       set(&B::blocked, true),
       set(&B::blocked, false),
       {Fault::kNone},
       8 * kMs,
       health(&rt::Health::frames_dropped)},
      {"13 bus-off",
       set(&B::state, hal::BusState::kBusOff),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusOff}},
      {"14 error-passive",
       set(&B::state, hal::BusState::kErrorPassive),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusNotActive}},
      {"14 error-warning",
       set(&B::state, hal::BusState::kErrorWarning),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kNone},
       300 * kMs,
       health(&rt::Health::bus_warnings)},
      {"15 interface down",
       set(&B::state, hal::BusState::kDown),
       set(&B::state, hal::BusState::kErrorActive),
       {Fault::kBusOff}},
      {"16 bit flips",
       set(&B::corrupt, 0.5),
       set(&B::corrupt, 0.0),
       {Fault::kLinkLost, Fault::kPeerStopped}},
      {"16 rare bit flips",
       set(&B::corrupt, 0.01),
       set(&B::corrupt, 0.0),
       {Fault::kNone},
       300 * kMs,
       link_counts(&Sent::damaged, &Received::damaged),
       true},
      {"17 loss", set(&B::lose, 0.8), set(&B::lose, 0.0), {Fault::kDataStale, Fault::kPeerStopped}},
      {"17 repetition",
       set(&B::duplicate, 0.3),
       set(&B::duplicate, 0.0),
       {Fault::kNone},
       300 * kMs,
       link_counts(&Sent::repeated, &Received::repeated),
       true},
      {"17 reordering",
       set(&B::reorder, 0.3),
       set(&B::reorder, 0.0),
       {Fault::kNone},
       300 * kMs,
       link_counts(&Sent::out_of_sequence, &Received::out_of_sequence),
       true},
      {"17 delay",
       set(&B::extra_delay_ns, 60 * kMs),
       set(&B::extra_delay_ns, 0),
       {Fault::kDataStale}},
      {"19 flood", set(&B::flood, 200U), set(&B::flood, 0U), {Fault::kRxOverflow}},
      {"21 robot silent", robot(&R::silent, true), robot(&R::silent, false), {Fault::kDataStale}},
      {"21 cable cut", set(&B::cut, true), set(&B::cut, false), {Fault::kDataStale}},
      {"21 another session answers",
       [](Cell& c) { c.robot_trouble.impostor = stranger(c, 77, 0); },
       [](Cell& c) { c.robot_trouble.impostor.reset(); },
       {Fault::kDataStale}},
      {"21 acknowledges what was not sent",
       [](Cell& c) { c.robot_trouble.impostor = stranger(c, 0, 9000); },
       [](Cell& c) { c.robot_trouble.impostor.reset(); },
       {Fault::kDataStale}},
      {"21 emergency stop",
       robot(&R::condition, link::RobotCondition{.enabled = true, .emergency_stop = true}),
       robot(&R::condition, kReady),
       {Fault::kRobotEmergencyStop}},
      {"21 protective stop for a moment",
       robot(&R::condition, link::RobotCondition{.enabled = true, .protective_stop = true}),
       robot(&R::condition, kReady),
       {Fault::kRobotProtectiveStop},
       2 * kMs},
      {"21 enabling device let go",
       robot(&R::condition, link::RobotCondition{}),
       robot(&R::condition, kReady),
       {Fault::kRobotNotEnabled}},
      {"23 tracking error",
       robot(&R::behind_mm, 6.0),
       robot(&R::behind_mm, 0.0),
       {Fault::kTrackingError}},
      {"gate: beside the path",
       robot(&R::aside_mm, 2.5),
       robot(&R::aside_mm, 0.0),
       {Fault::kOutsideCorridor}},
      {"gate: metres away",
       robot(&R::aside_mm, 3500.0),
       robot(&R::aside_mm, 0.0),
       {Fault::kTrackingError}},
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
       {Fault::kOutsideCorridor},
       800 * kMs},
      {"gate: seam in doubt",
       [](Cell& c) { c.vision.doubts = true; },
       [](Cell& c) { c.vision.doubts = false; },
       {Fault::kConfidenceLow}},
      {"24 one overrun",
       [](Cell& c) { c.stall_ns = 3 * kMs; },
       nothing,
       {Fault::kNone},
       300 * kMs,
       health(&rt::Health::overruns)},
      {"24 overruns", stall_three_times, nothing, {Fault::kOverrun}},
      {"25 suspended",
       [](Cell& c) { c.stall_ns = 3'600'000 * kMs / 1000; },
       nothing,
       {Fault::kClockJump}},
      {"26 vision thread hangs",
       [](Cell& c) { c.vision.hangs = true; },
       [](Cell& c) { c.vision.hangs = false; },
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
