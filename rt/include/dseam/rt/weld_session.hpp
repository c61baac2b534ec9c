// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/link/sender.hpp"
#include "dseam/rt/arc_gate.hpp"
#include "dseam/rt/cycle.hpp"
#include "dseam/rt/fault.hpp"
#include "dseam/rt/health.hpp"
#include "dseam/rt/motion_gate.hpp"
#include "dseam/rt/path_tracker.hpp"
#include "dseam/rt/session_machine.hpp"
#include "dseam/rt/timing/deadline.hpp"

namespace dseam::rt {

/// One weld from the scan to the retracted torch, on the cycle: reads the bus, watches, lets both
/// gates decide, drives the link, writes the bus. A fault turns the arc off with the first frame
/// that leaves in the cycle that finds it, and then stops the torch on its path.
///
/// Memory:  none of its own beyond the object; link, bus and set points outlive it.
/// Time:    step() is bounded by Config::frames_per_cycle.
/// Context: one thread, the cycle's; connect() and plan() while nothing moves.
class WeldSession {
 public:
  struct Config {
    ArcGate::Config arc;
    MotionGate::Config motion;
    PathTracker::Config tracker;
    std::int64_t silence_ns = 20'000'000;        ///< A bus that takes nothing for so long is lost.
    std::int64_t vision_limit_ns = 0;            ///< 0: welds without the vision thread.
    std::int64_t rest_limit_ns = 1'000'000'000;  ///< By then a tripped robot has stopped itself.
    unsigned max_overruns = 3;                   ///< Of the last
    unsigned overrun_window = 64;                ///< cycles; at most 64.
    std::uint32_t frames_per_cycle = 64;         ///< Read at most.
    std::uint32_t send_retries = 2;              ///< For a frame that the bus did not take.
    bool allow_degraded = false;                 ///< Arm although the system is not real-time.
  };
  /// What one cycle is told from outside the bus.
  struct Inputs {
    Cycle::Tick tick;
    bool operator_enable = false;  ///< First arming condition: a person or a cell controller.
    bool real_time = false;        ///< Scheduling, memory and processor are as asked for.
    /// What a camera that watches the weld makes of the seam, and for how long it has been silent.
    /// Without such a camera both stay as they are: then the set points' own confidence counts
    /// alone.
    seam::Confidence confidence = seam::Confidence::kHigh;
    std::int64_t vision_silent_ns = 0;
  };

  /// Errors:  kInvalidArgument: a limit out of range.
  [[nodiscard]] static Result<WeldSession> make(const Config& config, link::Sender& link,
                                                hal::CanBus& bus) noexcept;

  /// Greets the robot with a session never used before; each arming needs one of its own.
  Result<> connect(std::uint32_t session, std::int64_t now_ns) noexcept;
  /// Offers a trajectory from where the torch stands. What the motion gate refuses is latched.
  ///
  /// Errors:  kUnavailable: there is no seam, or a weld is on. kBadData: refused.
  Result<> plan(const torch::TorchPose& now, trajectory::SetPointView points) noexcept;
  /// Any order but kPlan, kFinished, kStopped, kFault.
  ///
  /// Errors:  kUnavailable: not now; counted.
  Result<> order(SessionEvent event) noexcept;
  /// A fault found elsewhere: a signal, the operator, the camera.
  void trip(Fault fault) noexcept;

  DSEAM_NONBLOCKING void step(const Inputs& in) noexcept;

  [[nodiscard]] SessionState state() const noexcept { return state_; }
  [[nodiscard]] Fault fault() const noexcept { return latch_.first(); }
  [[nodiscard]] const Health& health() const noexcept { return health_; }
  /// Both arming conditions hold, the operator's came after the last disarming, and the robot says
  /// that it is ready.
  [[nodiscard]] bool may_arm() const noexcept;

 private:
  static constexpr std::size_t kMaxFrames = 32;  ///< Sent in one cycle.

  WeldSession(const Config& config, const ArcGate& arc, const MotionGate& motion,
              link::Sender& link, hal::CanBus& bus) noexcept;
  [[nodiscard]] bool link_allows(SessionEvent event) const noexcept;
  Result<> apply(SessionEvent event) noexcept;
  void act(SessionAction action) noexcept;
  Result<> begin(SessionAction action) noexcept;
  void receive() noexcept;
  void watch_operator(bool enable) noexcept;
  [[nodiscard]] Fault supervise() noexcept;
  [[nodiscard]] Fault robot_fault() const noexcept;
  [[nodiscard]] Fault link_fault() const noexcept;
  void follow_link() noexcept;
  [[nodiscard]] bool at_rest() const noexcept;
  void guard_arc() noexcept;
  void permit(bool permitted) noexcept;
  void transmit() noexcept;
  [[nodiscard]] bool push(const hal::CanFrame& frame) noexcept;
  void count() noexcept;

  Config config_;
  ArcGate arc_gate_;
  MotionGate motion_gate_;
  PathTracker tracker_;
  OverrunMonitor overruns_;
  link::Sender& link_;
  hal::CanBus& bus_;

  SessionState state_ = SessionState::kIdle;
  FaultLatch latch_;
  Health health_;
  Inputs in_;
  trajectory::SetPointView points_;
  std::array<link::Frame, kMaxFrames> frames_{};
  std::int64_t now_ns_ = 0;
  std::int64_t status_ns_ = 0;  ///< When the newest status came,
  std::uint64_t statuses_ = 0;  ///< and its number, from 1.
  std::int64_t blocked_since_ns_ = 0;
  std::int64_t tripped_ns_ = 0;
  std::uint16_t trajectory_ = 0;
  bool blocked_ = false;
  bool session_used_ = true;  ///< The link's session was armed already, or there is none.
  bool enable_ = false;
  bool enable_edge_ = false;  ///< The operator's condition came anew.
  bool arc_ready_ = false;    ///< Not after a hold: a broken bead is taken up by a new plan.
  bool permitted_ = false;
};

}  // namespace dseam::rt
