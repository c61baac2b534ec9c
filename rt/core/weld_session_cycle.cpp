// SPDX-License-Identifier: Apache-2.0
// One cycle: read the bus, watch, decide, write the bus.
#include <chrono>

#include "dseam/hal/bus/link_port.hpp"
#include "dseam/rt/weld_session.hpp"

namespace dseam::rt {
namespace {

bool heartbeats(SessionState state) noexcept {
  return state >= SessionState::kArmed && state <= SessionState::kStopping;
}

}  // namespace

void WeldSession::step(const Inputs& in) noexcept {
  in_ = in;
  now_ns_ = in.tick.woke_ns;
  receive();
  watch_operator(in.operator_enable);
  trip(supervise());
  follow_link();
  guard_arc();
  transmit();
  count();
}

void WeldSession::receive() noexcept {
  for (std::uint32_t i = 0; i < config_.frames_per_cycle; ++i) {
    const Result<hal::CanFrame> frame = bus_.receive(std::chrono::nanoseconds{0});
    if (!frame.ok()) {
      return;
    }
    ++health_.frames_received;
    if (!frame.value().extended) {  // 29-bit identifiers are never ours.
      link_.on_frame(hal::to_link(frame.value()), now_ns_);
    }
  }
  ++health_.receive_full;
}

/// Arming takes an edge of the operator's condition; losing it stops.
void WeldSession::watch_operator(bool enable) noexcept {
  enable_edge_ = enable && (enable_edge_ || !enable_);
  const bool lost = enable_ && !enable;
  enable_ = enable;
  if (lost) {
    (void)apply(SessionEvent::kDisarm);
  }
}

/// What must hold as long as there is a heartbeat, arc or no arc.
Fault WeldSession::supervise() noexcept {
  const hal::BusHealth health = bus_.health();
  const hal::BusState bus = health.state;
  const bool lost_frames = health.receive_overflow > health_.receive_overflow;  // This cycle.
  overruns_.add(in_.tick.skipped > 0);
  if (link_.report().statuses != statuses_) {
    statuses_ = link_.report().statuses;
    status_ns_ = now_ns_;
  }
  if (!heartbeats(state_)) {
    return Fault::kNone;
  }
  if (bus == hal::BusState::kBusOff || bus == hal::BusState::kDown) {
    link_.bus_lost(now_ns_);
    return Fault::kBusOff;
  }
  if (in_.tick.gap) {
    return Fault::kClockJump;
  }
  if (overruns_.tripped()) {
    return Fault::kOverrun;
  }
  if (config_.vision_limit_ns > 0 && in_.vision_silent_ns > config_.vision_limit_ns) {
    return Fault::kVisionSilent;
  }
  if (blocked_ && now_ns_ - blocked_since_ns_ > config_.silence_ns) {
    return Fault::kTxBlocked;
  }
  if (lost_frames) {
    return Fault::kRxOverflow;
  }
  if (!in_.real_time && !config_.allow_degraded) {
    return Fault::kPrivilege;
  }
  const Fault robot = robot_fault();  // Before what follows from it on the link.
  return robot == Fault::kNone ? link_fault() : robot;
}

/// What the robot's newest status says of the robot itself.
Fault WeldSession::robot_fault() const noexcept {
  const link::Status& status = link_.status();
  if (status.session == 0) {
    return Fault::kNone;  // It has said nothing yet.
  }
  if (status.condition.emergency_stop) {
    return Fault::kRobotEmergencyStop;
  }
  if (status.condition.protective_stop) {
    return Fault::kRobotProtectiveStop;
  }
  return status.condition.enabled ? Fault::kNone : Fault::kRobotNotEnabled;
}

Fault WeldSession::link_fault() const noexcept {
  switch (link_.fault()) {
    case link::Fault::kNone:
      return Fault::kNone;
    case link::Fault::kPeerFault:
      return Fault::kPeerStopped;
    case link::Fault::kStatusSilent:
      return Fault::kDataStale;
    default:
      return Fault::kLinkLost;
  }
}

void WeldSession::follow_link() noexcept {
  const bool under_way = state_ == SessionState::kRunning || state_ == SessionState::kHold;
  if (under_way && link_.state() == link::HostState::kDone) {
    (void)apply(SessionEvent::kFinished);
  } else if (state_ == SessionState::kStopping && link_.state() == link::HostState::kIdle) {
    (void)apply(SessionEvent::kStopped);
  } else if (state_ == SessionState::kFault && at_rest()) {
    (void)apply(SessionEvent::kStopped);
  }
}

/// The robot says that it rests with the arc off, or has had the time that its own duty takes.
bool WeldSession::at_rest() const noexcept {
  const link::Status& status = link_.status();
  const bool stands =
      status.state == link::RobotState::kIdle || status.state >= link::RobotState::kSafe;
  const bool says_so = status_ns_ > tripped_ns_ && !status.arc_on && stands;
  return says_so || now_ns_ - tripped_ns_ > config_.rest_limit_ns;
}

void WeldSession::guard_arc() noexcept {
  if (state_ != SessionState::kRunning || link_.state() != link::HostState::kRunning) {
    return;
  }
  ArcInputs in;
  in.armed = link_.armed();
  in.data_age_ns = now_ns_ - status_ns_;
  in.confidence = in_.confidence;
  in.bus = bus_.health().state;
  in.overrun = overruns_.tripped();
  tracker_.look(link_.pose(), link_.executed(), now_ns_, in);
  const Fault fault = arc_gate_.check(in);
  trip(fault);
  permit(fault == Fault::kNone && arc_ready_);
}

void WeldSession::transmit() noexcept {
  Buffer<link::Frame> out(frames_);
  link_.poll(now_ns_, out);
  bool blocked = false;
  for (const link::Frame& frame : out.view()) {
    // Once one found no room the rest stays behind as well: order matters, and the link repeats.
    blocked = blocked || !push(hal::to_can(frame));
    ++(blocked ? health_.frames_dropped : health_.frames_sent);
  }
  if (blocked && !blocked_) {
    blocked_since_ns_ = now_ns_;
  }
  blocked_ = blocked || (blocked_ && out.empty());
}

bool WeldSession::push(const hal::CanFrame& frame) noexcept {
  for (std::uint32_t i = 0; i <= config_.send_retries; ++i) {
    const Result<> sent = bus_.send(frame);
    if (sent.ok()) {
      return true;
    }
    if (sent.error() != Errc::kQueueFull) {
      return false;  // Gone: supervise() sees it in the bus' state.
    }
  }
  return false;
}

void WeldSession::count() noexcept {
  const hal::BusHealth bus = bus_.health();
  health_.now_ns = now_ns_;
  health_.state = state_;
  health_.fault = latch_.first();
  health_.link_fault = link_.fault();
  health_.robot_fault = robot_fault();
  health_.bus = bus.state;
  health_.arc_permitted = permitted_;
  health_.arc_on = link_.status().arc_on;
  ++health_.cycles;
  health_.skipped += in_.tick.skipped;
  health_.overruns = overruns_.total();
  health_.faults = latch_.count();
  health_.receive_overflow = bus.receive_overflow;
  const bool weak =
      bus.state == hal::BusState::kErrorWarning || bus.state == hal::BusState::kErrorPassive;
  health_.bus_warnings += weak ? 1 : 0;
}

}  // namespace dseam::rt
