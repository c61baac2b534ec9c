// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/base/result.hpp"
#include "dseam/link/channel.hpp"
#include "dseam/link/point_store.hpp"

namespace dseam::link {

/// A point whose time has come.
struct DuePoint {
  std::uint32_t session = 0;
  std::uint16_t trajectory = 0;
  std::uint32_t index = 0;
  bool arc_on = false;  ///< What the torch does, not what the point asks for.
  trajectory::SetPoint point;
};

/// The robot's end of the weld link: keeps the session, the buffer, the path time and the duty to
/// stop. It is the reference for whoever builds the other side.
///
/// Safe state: the arc goes off at once, then the path is left along itself within `stop_ns`.
/// Reached by silence, invalid protection, a foreign session, a buffer that runs low, ABORT.
/// The way out is HELLO with a session never used before, then RESET.
///
/// Memory:  the point buffer, from the arena at make(); nothing later.
/// Time:    on_frame() O(1); poll() O(1) and at most four messages.
/// Context: one thread; times are the caller's monotonic clock.
class Receiver {
 public:
  struct Config {
    Addressing addressing;
    std::int64_t silence_limit_ns = 20'000'000;  ///< 4 to 200 ms.
    std::int64_t armed_period_ns = 5'000'000;    ///< STATUS while armed.
    std::int64_t idle_period_ns = 20'000'000;    ///< STATUS otherwise; POSE always.
    std::int64_t prefill_ns = 300'000'000;       ///< Verified path time that START needs.
    std::int64_t stop_ns = 200'000'000;          ///< From full speed to standstill on the path.
    std::uint16_t min_period_us = 500;
    double max_speed_mm_s = 500.0;
    std::uint32_t dictionary_crc = kDictionaryCrc;  ///< 0 accepts any.
  };

  /// Counters since make(); they only rise.
  struct Report {
    std::uint64_t accepted = 0;         ///< Messages acted upon.
    std::uint64_t damaged = 0;          ///< Failed the CRC or had the wrong length.
    std::uint64_t repeated = 0;         ///< Seen before.
    std::uint64_t out_of_sequence = 0;  ///< Old, or too much missing.
    std::uint64_t malformed = 0;        ///< Whole, but contradicting itself.
    std::uint64_t foreign_session = 0;
    std::uint64_t out_of_order_points = 0;
    std::uint64_t bad_marks = 0;  ///< Points thrown away because their CRC-32 was wrong.
    std::uint64_t trips = 0;      ///< Times the safe state was entered.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t capacity_points) noexcept {
    return Arena::bytes<PointStore::Slot>(capacity_points);
  }
  /// Errors:  kInvalidArgument: a limit out of range. kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<Receiver> make(const Config& config, std::uint16_t capacity_points,
                                             Arena& arena) noexcept;

  DSEAM_NONBLOCKING void on_frame(const Frame& frame, std::int64_t now_ns) noexcept;
  /// Advances the path, keeps the duties, and appends what is due to be sent.
  DSEAM_NONBLOCKING void poll(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  /// The next point to move to, each one once and in order; false when none is due.
  [[nodiscard]] DSEAM_NONBLOCKING bool take_due(DuePoint& out) noexcept;
  /// The bus was lost or purged: as good as silence.
  void bus_lost(std::int64_t now_ns) noexcept { trip(Fault::kBusLost, now_ns); }
  /// What the next POSE message says.
  void report_pose(const torch::TorchPose& pose, double speed_mm_s) noexcept;
  /// What STATUS says of the robot from now on; a change is sent with the next poll(). Only tells:
  /// what stops the robot then is its own controller, and the host.
  void report_condition(const RobotCondition& condition) noexcept;

  [[nodiscard]] RobotState state() const noexcept { return state_; }
  [[nodiscard]] Fault fault() const noexcept { return fault_; }
  [[nodiscard]] std::uint32_t session() const noexcept { return session_; }
  [[nodiscard]] bool arc_on() const noexcept;
  [[nodiscard]] bool moving() const noexcept { return rate_ > 0.0; }
  /// Time along the path, which runs slower than the clock while it stops.
  [[nodiscard]] std::int64_t path_ns() const noexcept { return path_ns_; }
  [[nodiscard]] const PointStore& points() const noexcept { return points_; }
  [[nodiscard]] const Report& report() const noexcept { return report_; }

 private:
  static constexpr std::size_t kRememberedSessions = 16;

  Receiver(const Config& config, std::span<PointStore::Slot> slots) noexcept
      : config_(config),
        transmitter_(config.addressing),
        acceptor_(config.addressing),
        points_(slots) {}

  bool count_status(const Accepted& accepted) noexcept;
  void dispatch(const Accepted& accepted, std::int64_t now_ns) noexcept;
  void on_hello(const Frame& frame) noexcept;
  void on_command(const Frame& frame, std::int64_t now_ns) noexcept;
  void on_abort(const Frame& frame, std::int64_t now_ns) noexcept;
  void on_trajectory(const Frame& frame) noexcept;
  void on_point(const Frame& frame) noexcept;

  void adopt_session(std::uint32_t session) noexcept;
  [[nodiscard]] bool used_before(std::uint32_t session) const noexcept;
  void follow(const Command& command, std::int64_t now_ns) noexcept;
  void follow_while_still(const Command& command, std::int64_t now_ns) noexcept;
  void follow_while_moving(Request request) noexcept;
  void set_permit(bool permit) noexcept;
  void stop(RobotState then) noexcept;
  void trip(Fault fault, std::int64_t now_ns) noexcept;
  void finish_stop() noexcept;
  void keep_duties(std::int64_t now_ns) noexcept;
  void advance_path(std::int64_t now_ns) noexcept;
  void ask_again(NackReason reason) noexcept;

  [[nodiscard]] bool armed() const noexcept;
  [[nodiscard]] bool ready_to_start() const noexcept;
  [[nodiscard]] std::int64_t buffered_ns() const noexcept;
  [[nodiscard]] Status status(std::int64_t now_ns) const noexcept;
  void send_nack(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void send_pose(std::int64_t now_ns, Buffer<Frame>& out) noexcept;

  Config config_;
  Transmitter transmitter_;
  Acceptor acceptor_;
  PointStore points_;
  Report report_;

  RobotState state_ = RobotState::kIdle;
  RobotState after_stop_ = RobotState::kIdle;
  Fault fault_ = Fault::kNone;
  std::uint32_t session_ = 0;
  std::array<std::uint32_t, kRememberedSessions> sessions_{};
  std::size_t session_count_ = 0;
  bool fresh_session_ = false;
  std::uint16_t trajectory_ = 0;
  bool begun_ = false;

  bool permit_ = false;
  bool arc_latched_off_ = false;  ///< Until the permit is withdrawn and given again.
  bool point_arc_ = false;
  double rate_ = 0.0;
  double target_rate_ = 0.0;
  std::int64_t path_ns_ = 0;
  std::int64_t last_poll_ns_ = 0;
  std::int64_t last_command_ns_ = 0;
  std::uint64_t last_host_time_us_ = 0;

  std::int64_t next_status_ns_ = 0;
  std::int64_t next_pose_ns_ = 0;
  std::int64_t next_nack_ns_ = 0;
  bool hello_due_ = false;
  bool nack_due_ = false;
  NackReason nack_reason_ = NackReason::kGap;
  bool pose_known_ = false;
  PoseReport pose_;
  RobotCondition condition_;
};

}  // namespace dseam::link
