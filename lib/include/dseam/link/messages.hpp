// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/trajectory/set_point.hpp"

namespace dseam::link {

/// The messages, in order of priority: the identifier on the bus is the base plus this number.
enum class MessageId : std::uint8_t {
  kAbort,
  kCommand,
  kStatus,
  kTrajectory,
  kNack,
  kPoint,
  kPose,
  kHelloHost,
  kHelloRobot,
};
inline constexpr std::uint8_t kMessageCount = 9;

/// What latched one end of the link into its safe state.
enum class Fault : std::uint8_t {
  kNone,
  kCommandSilent,   ///< The robot heard no valid command for the silence limit.
  kStatusSilent,    ///< The host heard no valid status for the silence limit.
  kE2eInvalid,      ///< Too many damaged frames in the window.
  kForeignSession,  ///< A valid command from another session while armed.
  kStarved,         ///< The buffer ran low before the trajectory was complete.
  kAborted,         ///< The other side, or the user, asked for it.
  kBusLost,         ///< Bus-off, interface down or gone.
  kNoPeer,          ///< Nobody answered HELLO.
  kIncompatible,    ///< The peer speaks another version, or its limits exclude the trajectory.
  kPeerFault,       ///< The robot reported its safe state.
  kRefused,         ///< The peer did not follow an order in time.
  kOverrun,         ///< The host missed its own deadline.
};

/// The name of the fault without its `k`, for logs and tests.
[[nodiscard]] constexpr const char* name(Fault fault) noexcept {
  constexpr const char* kNames[] = {"None",           "CommandSilent", "StatusSilent", "E2eInvalid",
                                    "ForeignSession", "Starved",       "Aborted",      "BusLost",
                                    "NoPeer",         "Incompatible",  "PeerFault",    "Refused",
                                    "Overrun"};
  return kNames[static_cast<std::uint8_t>(fault)];
}
inline constexpr std::uint8_t kFaultCount = 13;

enum class Request : std::uint8_t { kIdle, kArm, kLoad, kStart, kHold, kStop, kReset };
inline constexpr std::uint8_t kRequestCount = 7;

enum class RobotState : std::uint8_t {
  kBoot,
  kIdle,
  kArmed,
  kLoading,
  kRunning,
  kHold,
  kStopping,
  kSafe,
  kFault,
};
inline constexpr std::uint8_t kRobotStateCount = 9;

/// Host to robot, repeated until the robot reports its safe state.
struct Abort {
  std::uint32_t session = 0;
  Fault reason = Fault::kAborted;
};

/// Host to robot, cyclic: the order that holds now, and the host's heartbeat.
struct Command {
  std::uint32_t session = 0;
  Request request = Request::kIdle;
  bool weld_permit = false;
  std::uint16_t trajectory = 0;
  std::uint64_t host_time_us = 0;  ///< 48 bits; rises strictly within a session.
};

/// What the robot's own controller says of itself, whatever the link does. Unless it says otherwise
/// the robot may not be armed.
struct RobotCondition {
  bool enabled = false;  ///< The mode of operation and the enabling device let it move.
  bool protective_stop = false;
  bool emergency_stop = false;

  friend constexpr bool operator==(const RobotCondition&, const RobotCondition&) = default;
};

/// Robot to host, cyclic. Sequence numbers are modulo 2^16 and name the next one expected.
struct Status {
  std::uint32_t session = 0;
  RobotState state = RobotState::kBoot;
  bool arc_on = false;
  std::uint16_t ack_seq = 0;       ///< Points received in order.
  std::uint16_t verified_seq = 0;  ///< Points whose CRC-32 was confirmed by a mark.
  std::uint16_t exec_seq = 0;      ///< Points executed.
  std::uint16_t credit = 0;        ///< Free places for points after ack_seq.
  std::uint16_t buffer_ms = 0;     ///< Verified path time ahead.
  std::uint16_t trajectory = 0;
  Fault fault = Fault::kNone;
  std::uint64_t robot_time_us = 0;  ///< 48 bits; rises strictly within a session.
  RobotCondition condition;
};

enum class TrajectoryKind : std::uint8_t { kBegin, kMark };
inline constexpr std::uint8_t kTrajectoryKindCount = 2;

/// Host to robot: announces a trajectory, then vouches for its points piece by piece. The robot
/// executes no point that a mark has not confirmed.
struct TrajectoryMark {
  std::uint32_t session = 0;
  TrajectoryKind kind = TrajectoryKind::kBegin;
  std::uint16_t trajectory = 0;
  std::uint32_t count = 0;  ///< kBegin: all points. kMark: the points that `crc` covers.
  std::uint32_t crc = 0;    ///< CRC-32 over bytes 3 to 47 of the first `count` point frames.
  std::uint32_t duration_us = 0;
  double length_mm = 0.0;
};

/// What the robot misses.
enum class NackReason : std::uint8_t { kGap, kBadMark, kNoRoom };
inline constexpr std::uint8_t kNackReasonCount = 3;

/// Robot to host: send again from `expected_seq`.
struct Nack {
  std::uint32_t session = 0;
  std::uint16_t trajectory = 0;
  std::uint16_t expected_seq = 0;
  NackReason reason = NackReason::kGap;
};

/// Host to robot: one point of the trajectory.
struct Point {
  std::uint32_t session = 0;
  std::uint16_t trajectory = 0;
  std::uint16_t seq = 0;
  bool first = false;
  bool last = false;
  trajectory::SetPoint set_point;
};

/// Robot to host: where the torch is.
struct PoseReport {
  std::uint32_t session = 0;
  std::uint64_t robot_time_us = 0;  ///< 48 bits.
  torch::TorchPose pose;
  double speed_mm_s = 0.0;
  std::uint16_t exec_seq = 0;
  bool arc_on = false;
};

/// Both directions: who speaks, and within which limits. The robot echoes the host's session.
struct Hello {
  std::uint32_t session = 0;
  std::uint8_t version = 0;
  std::uint32_t dictionary_crc = 0;   ///< CRC-32 of the text of weld-link.dbc.
  std::uint16_t buffer_points = 0;    ///< Robot: places for points. Host: 0.
  std::uint16_t min_period_us = 0;    ///< Robot: least time between two points. Host: 0.
  std::uint8_t silence_limit_ms = 0;  ///< The sender's own limit.
  double max_speed_mm_s = 0.0;        ///< Robot: fastest point it accepts. Host: 0.
};

inline constexpr std::uint8_t kProtocolVersion = 1;
/// CRC-32 of the text of docs/weld-link.dbc: both ends were built from the same dictionary.
inline constexpr std::uint32_t kDictionaryCrc = 0x56FA9D14;

}  // namespace dseam::link
