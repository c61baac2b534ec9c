// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/fault.hpp"

namespace dseam::rt {

const char* name(Fault fault) noexcept {
  constexpr const char* kNames[] = {"None",
                                    "NotArmed",
                                    "DataStale",
                                    "ConfidenceLow",
                                    "StreamStopped",
                                    "BusNotActive",
                                    "TrackingError",
                                    "SpeedOutOfWindow",
                                    "OutsideWorkspace",
                                    "OutsideCorridor",
                                    "Overrun",
                                    "Standstill",
                                    "SetPointNotFinite",
                                    "SetPointJump",
                                    "SetPointSpeed",
                                    "SetPointAcceleration",
                                    "SetPointJerk",
                                    "SetPointTurn",
                                    "SetPointEnd",
                                    "SetPointOrder",
                                    "VisionSilent",
                                    "ClockJump",
                                    "TxBlocked",
                                    "BusOff",
                                    "RxOverflow",
                                    "LinkLost",
                                    "PeerStopped",
                                    "RobotEmergencyStop",
                                    "RobotProtectiveStop",
                                    "RobotNotEnabled",
                                    "Privilege",
                                    "Operator"};
  static_assert(sizeof(kNames) / sizeof(kNames[0]) == kNumFaults);
  const auto i = static_cast<std::uint8_t>(fault);
  return i < kNumFaults ? kNames[i] : "Unknown";
}

}  // namespace dseam::rt
