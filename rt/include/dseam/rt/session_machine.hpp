// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::rt {

/// Where a weld stands.
enum class SessionState : std::uint8_t {
  kIdle,      ///< Nothing known of the part.
  kScanned,   ///< There is a seam.
  kPlanned,   ///< There is a trajectory that the motion gate let pass.
  kArmed,     ///< Both ends keep the heartbeat; the arc may come on.
  kLoading,   ///< The trajectory is on its way to the robot.
  kRunning,   ///< The torch moves along it.
  kHold,      ///< It stopped on the path, arc off, and may go on.
  kStopping,  ///< Controlled stop, arc off, by order.
  kSafe,      ///< Fault latched, torch at rest or out of reach; a reset leads out.
  kFault,     ///< Fault latched, torch still coming to rest.
};
inline constexpr std::uint8_t kNumSessionStates = 10;

enum class SessionEvent : std::uint8_t {
  kScan,     ///< A seam was found and accepted.
  kPlan,     ///< A trajectory passed the motion gate.
  kDiscard,  ///< Seam and plan are given up.
  kArm,      ///< Both arming conditions hold, and one of them has just come.
  kDisarm,   ///< One of them went.
  kLoad,
  kStart,
  kHold,
  kStop,
  kFinished,  ///< The last set point was executed.
  kStopped,   ///< The robot reports rest with the arc off.
  kFault,     ///< A gate, a monitor or the link tripped.
  kReset,     ///< The operator's reset, as an edge.
};
inline constexpr std::uint8_t kNumSessionEvents = 13;

/// What the session does on the way.
enum class SessionAction : std::uint8_t {
  kNothing,
  kRefuse,  ///< The event is not allowed here; answered and counted.
  kBeginArming,
  kBeginLoading,
  kBeginRunning,
  kBeginHold,
  kBeginStop,  ///< Controlled stop, arc off first.
  kTrip,       ///< Arc off now, then the controlled stop.
  kForget,     ///< Drops seam, plan and session.
};

struct SessionStep {
  SessionState next = SessionState::kFault;
  SessionAction action = SessionAction::kTrip;

  friend constexpr bool operator==(const SessionStep&, const SessionStep&) = default;
};

/// Every event in every state. Values that are no state or no event lead to kFault and kTrip.
[[nodiscard]] SessionStep session_step(SessionState state, SessionEvent event) noexcept;

[[nodiscard]] const char* name(SessionState state) noexcept;
[[nodiscard]] const char* name(SessionEvent event) noexcept;

}  // namespace dseam::rt
