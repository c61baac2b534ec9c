// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/link/receiver.hpp"
#include "dseam/rt/weld_session.hpp"
#include "rt/session/cell/virtual_bus.hpp"
#include "rt/session/cell/virtual_vision.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {

/// What a robot does that it should not.
struct RobotTrouble {
  bool silent = false;                              ///< Sends nothing, hears all.
  bool frozen = false;                              ///< Its pose stays where it is,
  double aside_mm = 0.0;                            ///< or lies beside the path,
  double behind_mm = 0.0;                           ///< or behind where it should be,
  double speed_factor = 1.0;                        ///< or it says another speed.
  link::RobotCondition condition{.enabled = true};  ///< Or it says that it was stopped.
  std::optional<link::Status> impostor;             ///< Or somebody else speaks in its place.
};

/// A host, a bus, a robot and a camera in one thread, under one virtual clock, driven by one seed,
/// which also says who comes first. What must hold at all times is checked in every cycle; the
/// first breach is kept as text.
class VirtualCell {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;
  explicit VirtualCell(std::uint64_t seed, rt::WeldSession::Config config = {});

  void run(std::int64_t ns);
  void cycle();
  /// Brings the session to `state` by the orders of a normal weld; false when it does not get
  /// there.
  bool bring_to(rt::SessionState state);
  /// One millisecond at a time until `done` or `limit_ns` have passed; says which.
  template <typename F>
  bool run_until(F done, std::int64_t limit_ns) {
    const std::int64_t end_ns = now_ns() + limit_ns;
    while (!done() && now_ns() < end_ns) {
      cycle();
    }
    return done();
  }

  [[nodiscard]] std::int64_t now_ns() noexcept { return clock.now_ns(); }
  [[nodiscard]] bool arc_on() const { return robot_.arc_on(); }
  [[nodiscard]] const link::Sender& sender() const { return sender_; }
  [[nodiscard]] const link::Receiver& robot() const { return robot_; }
  [[nodiscard]] std::size_t executed() const { return executed_; }
  [[nodiscard]] std::int64_t arc_on_ns() const { return arc_on_ns_; }
  [[nodiscard]] std::size_t path_points() const { return points_.size(); }
  [[nodiscard]] const trajectory::SetPointView points() const { return points_; }
  /// A digest of every frame, state and decision so far.
  [[nodiscard]] std::uint64_t digest() const { return digest_; }
  /// Empty while everything held.
  [[nodiscard]] const std::string& breach() const { return breach_; }
  std::uint32_t new_session() { return next_session_++; }

  hal::fake::ManualClock clock;
  VirtualBus bus;
  VirtualVision vision;
  RobotTrouble robot_trouble;
  rt::WeldSession::Inputs inputs;
  std::int64_t stall_ns = 0;  ///< The next cycle takes so much longer.

 private:
  static std::vector<trajectory::SetPoint> weld_points();
  void host_cycle();
  void robot_cycle();
  void move_robot();
  void speak(const Buffer<link::Frame>& frames);
  void check();
  void broke(const char* what);
  void mix(std::uint64_t value) { digest_ = (digest_ ^ value) * 0x100000001B3ULL; }

  std::vector<trajectory::SetPoint> points_;
  ArenaOwner memory_;
  link::Sender sender_;
  link::Receiver robot_;
  link::Transmitter impostor_{link::Addressing{}};

 public:
  rt::WeldSession session;

 private:
  Pcg32 random_;
  std::uint32_t next_session_ = 1;
  torch::TorchPose robot_pose_;
  double robot_speed_mm_s_ = 0.0;
  std::int64_t path_before_ns_ = 0;
  std::size_t executed_ = 0;
  std::uint16_t trajectory_ = 0;
  std::int64_t arc_on_ns_ = 0;
  bool armed_before_ = false;
  rt::Fault fault_before_ = rt::Fault::kNone;
  std::int64_t tripped_ns_ = 0;
  std::uint64_t digest_ = 0xCBF29CE484222325ULL;
  std::string breach_;
};

}  // namespace dseam::test
