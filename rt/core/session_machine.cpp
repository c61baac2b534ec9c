// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/session_machine.hpp"

namespace dseam::rt {
namespace {

using S = SessionState;
using A = SessionAction;

constexpr SessionStep stay(S s) noexcept { return {s, A::kNothing}; }
constexpr SessionStep no(S s) noexcept { return {s, A::kRefuse}; }
constexpr SessionStep kTripped{S::kFault, A::kTrip};
constexpr SessionStep kHalt{S::kStopping, A::kBeginStop};

// Rows: states. Columns: kScan, kPlan, kDiscard, kArm, kDisarm, kLoad, kStart, kHold, kStop,
// kFinished, kStopped, kFault, kReset.
//
// A fault before arming is latched as well: whatever it is, no arc may come after it unasked.
// kDisarm while armed stops like kStop. In kFault only rest leads on, and only to kSafe.
constexpr SessionStep kTable[kNumSessionStates][kNumSessionEvents] = {
    /* kIdle */
    {stay(S::kScanned), no(S::kIdle), stay(S::kIdle), no(S::kIdle), stay(S::kIdle), no(S::kIdle),
     no(S::kIdle), no(S::kIdle), stay(S::kIdle), stay(S::kIdle), stay(S::kIdle), kTripped,
     no(S::kIdle)},
    /* kScanned */
    {stay(S::kScanned),
     stay(S::kPlanned),
     {S::kIdle, A::kForget},
     no(S::kScanned),
     stay(S::kScanned),
     no(S::kScanned),
     no(S::kScanned),
     no(S::kScanned),
     stay(S::kScanned),
     stay(S::kScanned),
     stay(S::kScanned),
     kTripped,
     no(S::kScanned)},
    /* kPlanned */
    {stay(S::kScanned),
     stay(S::kPlanned),
     {S::kIdle, A::kForget},
     {S::kArmed, A::kBeginArming},
     stay(S::kPlanned),
     no(S::kPlanned),
     no(S::kPlanned),
     no(S::kPlanned),
     stay(S::kPlanned),
     stay(S::kPlanned),
     stay(S::kPlanned),
     kTripped,
     no(S::kPlanned)},
    /* kArmed */
    {no(S::kArmed),
     no(S::kArmed),
     no(S::kArmed),
     no(S::kArmed),
     kHalt,
     {S::kLoading, A::kBeginLoading},
     no(S::kArmed),
     no(S::kArmed),
     kHalt,
     stay(S::kArmed),
     stay(S::kArmed),
     kTripped,
     no(S::kArmed)},
    /* kLoading */
    {no(S::kLoading),
     no(S::kLoading),
     no(S::kLoading),
     no(S::kLoading),
     kHalt,
     no(S::kLoading),
     {S::kRunning, A::kBeginRunning},
     no(S::kLoading),
     kHalt,
     stay(S::kLoading),
     stay(S::kLoading),
     kTripped,
     no(S::kLoading)},
    /* kRunning */
    {no(S::kRunning),
     no(S::kRunning),
     no(S::kRunning),
     no(S::kRunning),
     kHalt,
     no(S::kRunning),
     no(S::kRunning),
     {S::kHold, A::kBeginHold},
     kHalt,
     kHalt,
     stay(S::kRunning),
     kTripped,
     no(S::kRunning)},
    /* kHold */
    {no(S::kHold),
     no(S::kHold),
     no(S::kHold),
     no(S::kHold),
     kHalt,
     no(S::kHold),
     {S::kRunning, A::kBeginRunning},
     stay(S::kHold),
     kHalt,
     kHalt,
     stay(S::kHold),
     kTripped,
     no(S::kHold)},
    /* kStopping */
    {no(S::kStopping),
     no(S::kStopping),
     no(S::kStopping),
     no(S::kStopping),
     stay(S::kStopping),
     no(S::kStopping),
     no(S::kStopping),
     no(S::kStopping),
     stay(S::kStopping),
     stay(S::kStopping),
     {S::kIdle, A::kForget},
     kTripped,
     no(S::kStopping)},
    /* kSafe */
    {no(S::kSafe),
     no(S::kSafe),
     no(S::kSafe),
     no(S::kSafe),
     stay(S::kSafe),
     no(S::kSafe),
     no(S::kSafe),
     no(S::kSafe),
     stay(S::kSafe),
     stay(S::kSafe),
     stay(S::kSafe),
     stay(S::kSafe),
     {S::kIdle, A::kForget}},
    /* kFault */
    {no(S::kFault), no(S::kFault), no(S::kFault), no(S::kFault), stay(S::kFault), no(S::kFault),
     no(S::kFault), no(S::kFault), stay(S::kFault), stay(S::kFault), stay(S::kSafe),
     stay(S::kFault), no(S::kFault)},
};

}  // namespace

SessionStep session_step(SessionState state, SessionEvent event) noexcept {
  const auto s = static_cast<std::uint8_t>(state);
  const auto e = static_cast<std::uint8_t>(event);
  if (s >= kNumSessionStates || e >= kNumSessionEvents) {
    return kTripped;
  }
  return kTable[s][e];
}

const char* name(SessionState state) noexcept {
  constexpr const char* kNames[kNumSessionStates] = {"Idle",    "Scanned", "Planned", "Armed",
                                                     "Loading", "Running", "Hold",    "Stopping",
                                                     "Safe",    "Fault"};
  const auto i = static_cast<std::uint8_t>(state);
  return i < kNumSessionStates ? kNames[i] : "Unknown";
}

const char* name(SessionEvent event) noexcept {
  constexpr const char* kNames[kNumSessionEvents] = {
      "Scan", "Plan", "Discard",  "Arm",     "Disarm", "Load", "Start",
      "Hold", "Stop", "Finished", "Stopped", "Fault",  "Reset"};
  const auto i = static_cast<std::uint8_t>(event);
  return i < kNumSessionEvents ? kNames[i] : "Unknown";
}

}  // namespace dseam::rt
