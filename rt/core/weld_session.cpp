// SPDX-License-Identifier: Apache-2.0
// Orders and what they do. weld_session_cycle.cpp has the cycle.
#include "dseam/rt/weld_session.hpp"

namespace dseam::rt {

Result<WeldSession> WeldSession::make(const Config& config, link::Sender& link,
                                      hal::CanBus& bus) noexcept {
  const auto arc = ArcGate::make(config.arc);
  const auto motion = MotionGate::make(config.motion);
  const bool times = config.silence_ns > 0 && config.vision_limit_ns >= 0 &&
                     config.rest_limit_ns >= config.silence_ns;
  const bool counts = config.max_overruns > 0 && config.overrun_window > 0 &&
                      config.overrun_window <= 64 && config.frames_per_cycle > 0;
  const bool tracker = config.tracker.standing_mm > 0.0 && config.tracker.settle_ns >= 0;
  if (!arc.ok() || !motion.ok() || !times || !counts || !tracker) {
    return Errc::kInvalidArgument;
  }
  return WeldSession(config, arc.value(), motion.value(), link, bus);
}

WeldSession::WeldSession(const Config& config, const ArcGate& arc, const MotionGate& motion,
                         link::Sender& link, hal::CanBus& bus) noexcept
    : config_(config),
      arc_gate_(arc),
      motion_gate_(motion),
      tracker_(config.tracker),
      overruns_(config.max_overruns, config.overrun_window),
      link_(link),
      bus_(bus) {}

Result<> WeldSession::connect(std::uint32_t session, std::int64_t now_ns) noexcept {
  if (state_ > SessionState::kPlanned) {
    return Errc::kUnavailable;
  }
  // What still waits in the queues belongs to a session that is over.
  const Result<> purged = bus_.purge();
  if (!purged.ok()) {
    return purged;
  }
  const Result<> connected = link_.connect(session, now_ns);
  session_used_ = session_used_ && !connected.ok();
  return connected;
}

Result<> WeldSession::plan(const torch::TorchPose& now, trajectory::SetPointView points) noexcept {
  if (points.empty() ||
      session_step(state_, SessionEvent::kPlan).action == SessionAction::kRefuse) {
    ++health_.refused;
    return Errc::kUnavailable;
  }
  const MotionGate::Verdict verdict = motion_gate_.check_all(now, points);
  if (verdict.fault != Fault::kNone) {
    trip(verdict.fault);
    return Errc::kBadData;
  }
  (void)link_.expect(points);  // What does not fit is refused when it is loaded.
  points_ = points;
  return apply(SessionEvent::kPlan);
}

bool WeldSession::may_arm() const noexcept {
  const bool system_ready = (in_.real_time || config_.allow_degraded) && !session_used_ &&
                            link_.state() == link::HostState::kIdle;
  return system_ready && robot_fault() == Fault::kNone && enable_ && enable_edge_;
}

/// Conditions that the table cannot know.
bool WeldSession::link_allows(SessionEvent event) const noexcept {
  switch (event) {
    case SessionEvent::kArm:
      return may_arm();
    case SessionEvent::kLoad:
      return link_.state() == link::HostState::kArmed;
    case SessionEvent::kStart:
      return link_.state() == link::HostState::kReady || link_.state() == link::HostState::kHold;
    case SessionEvent::kHold:
      return link_.state() == link::HostState::kRunning || state_ == SessionState::kHold;
    case SessionEvent::kPlan:
    case SessionEvent::kFinished:
    case SessionEvent::kStopped:
    case SessionEvent::kFault:
      return false;
    default:
      return true;
  }
}

Result<> WeldSession::order(SessionEvent event) noexcept {
  if (!link_allows(event)) {
    ++health_.refused;
    return Errc::kUnavailable;
  }
  return apply(event);
}

void WeldSession::trip(Fault fault) noexcept {
  if (latch_.set(fault)) {
    (void)apply(SessionEvent::kFault);
  }
}

Result<> WeldSession::apply(SessionEvent event) noexcept {
  const SessionStep step = session_step(state_, event);
  if (step.action == SessionAction::kRefuse) {
    ++health_.refused;
    return Errc::kUnavailable;
  }
  state_ = step.next;
  act(step.action);
  return {};
}

void WeldSession::act(SessionAction action) noexcept {
  switch (action) {
    case SessionAction::kBeginStop:
      permit(false);
      if (!link_.stop(now_ns_).ok()) {
        link_.abort(link::Fault::kAborted, now_ns_);
      }
      break;
    case SessionAction::kTrip:
      permit(false);
      link_.abort(link::Fault::kAborted, now_ns_);
      tripped_ns_ = now_ns_;
      break;
    case SessionAction::kForget:
      points_ = {};
      latch_.clear();
      overruns_.clear();
      enable_edge_ = false;
      break;
    default:
      if (!begin(action).ok()) {
        trip(Fault::kLinkLost);  // The link contradicts what it said a moment ago.
      }
      break;
  }
}

Result<> WeldSession::begin(SessionAction action) noexcept {
  switch (action) {
    case SessionAction::kBeginArming:
      session_used_ = true;
      enable_edge_ = false;
      arc_ready_ = true;
      return link_.arm(now_ns_);
    case SessionAction::kBeginLoading:
      trajectory_ = static_cast<std::uint16_t>(trajectory_ % 65'535U + 1U);  // Never 0.
      return link_.load(points_, trajectory_, now_ns_);
    case SessionAction::kBeginRunning:
      tracker_.begin(points_, now_ns_);
      return link_.start(now_ns_);
    case SessionAction::kBeginHold:
      permit(false);
      arc_ready_ = false;
      return link_.hold(now_ns_);
    default:
      return {};
  }
}

void WeldSession::permit(bool permitted) noexcept {
  if (permitted != permitted_) {
    permitted_ = permitted;
    link_.permit_weld(permitted);
  }
}

}  // namespace dseam::rt
