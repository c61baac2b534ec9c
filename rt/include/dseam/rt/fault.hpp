// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::rt {

/// Why the arc went off and the torch stopped. Latched: only a reset takes it back.
enum class Fault : std::uint8_t {
  kNone,
  kNotArmed,              ///< Arc gate: the session is not armed.
  kDataStale,             ///< Arc gate: what the weld rests on is too old.
  kConfidenceLow,         ///< Arc gate: the seam is not certain enough here.
  kStreamStopped,         ///< Arc gate: the robot gets no further along its set points.
  kBusNotActive,          ///< Arc gate: the controller left error-active.
  kTrackingError,         ///< Arc gate: the torch is not where it was sent.
  kSpeedOutOfWindow,      ///< Arc gate: the torch moves too slowly or too fast.
  kOutsideWorkspace,      ///< Either gate: the torch is, or is sent, out of its box.
  kOutsideCorridor,       ///< Arc gate: the torch is too far beside the planned path.
  kOverrun,               ///< The cycle missed its period too often.
  kStandstill,            ///< Arc gate: the torch stands with the arc on.
  kSetPointNotFinite,     ///< Motion gate.
  kSetPointJump,          ///< Motion gate: also a start that is not where the torch is.
  kSetPointSpeed,         ///< Motion gate.
  kSetPointAcceleration,  ///< Motion gate.
  kSetPointJerk,          ///< Motion gate.
  kSetPointTurn,          ///< Motion gate: it turns too fast.
  kSetPointEnd,           ///< Motion gate: it could not stand still after the last one.
  kSetPointOrder,         ///< Motion gate: times that do not rise.
  kVisionSilent,          ///< The vision thread gives no sign of life.
  kClockJump,             ///< Time passed that no cycle saw: suspended, or stopped by a debugger.
  kTxBlocked,             ///< The bus takes no frames for longer than the silence limit.
  kBusOff,                ///< Bus-off, down or gone.
  kRxOverflow,            ///< Frames of the robot were lost for want of room.
  kLinkLost,              ///< The weld link latched its safe state.
  kPeerStopped,           ///< The robot left the running state by itself.
  kRobotEmergencyStop,    ///< The robot says that its emergency stop is pressed,
  kRobotProtectiveStop,   ///< that a protective stop holds it,
  kRobotNotEnabled,       ///< that its mode or its enabling device lets it not move.
  kPrivilege,             ///< Real-time scheduling or memory locking was refused.
  kOperator,              ///< The operator, a signal or the program asked for it.
};
inline constexpr std::uint8_t kNumFaults = 32;

/// The name of the fault without its `k`, for logs and tests.
[[nodiscard]] const char* name(Fault fault) noexcept;

/// Keeps the first fault and counts those that follow.
class FaultLatch {
 public:
  /// True when this is the first one.
  bool set(Fault fault) noexcept {
    if (fault == Fault::kNone) {
      return false;
    }
    ++count_;
    if (first_ != Fault::kNone) {
      return false;
    }
    first_ = fault;
    return true;
  }
  void clear() noexcept { first_ = Fault::kNone; }
  [[nodiscard]] Fault first() const noexcept { return first_; }
  [[nodiscard]] bool any() const noexcept { return first_ != Fault::kNone; }
  /// All that were ever set.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  Fault first_ = Fault::kNone;
  std::uint64_t count_ = 0;
};

}  // namespace dseam::rt
