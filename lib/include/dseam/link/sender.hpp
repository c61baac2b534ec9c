// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "dseam/base/buffer.hpp"
#include "dseam/base/expects.hpp"
#include "dseam/base/result.hpp"
#include "dseam/link/channel.hpp"
#include "dseam/link/point_stream.hpp"

namespace dseam::link {

/// How far the host has come with the robot. From kArmed to kDone both sides keep the heartbeat.
enum class HostState : std::uint8_t {
  kOffline,
  kConnecting,
  kIdle,
  kArming,
  kArmed,
  kLoading,
  kReady,  ///< Enough of the trajectory is confirmed to start.
  kStarting,
  kRunning,
  kHold,
  kStopping,
  kDone,  ///< The last point was executed; still armed.
  kSafe,  ///< Latched; see fault(). Only connect() with a new session leads out.
};

/// The host's end of the weld link: session, heartbeat, orders, and the points of a trajectory by
/// go-back-N with credits. Every poll() sends abort first, then the heartbeat, then points.
///
/// Memory:  none; the trajectory stays the caller's and must outlive its execution.
/// Time:    on_frame() O(1); poll() at most `points_per_poll` points; load() O(1) for points
///          that expect() has seen in this session, else as that O(points).
/// Context: one thread; times are the caller's monotonic clock.
/// Errors:  an order that the state does not allow is kUnavailable and changes nothing.
class Sender {
 public:
  struct Config {
    Addressing addressing;
    std::int64_t silence_limit_ns = 20'000'000;  ///< 4 to 200 ms.
    std::int64_t armed_period_ns = 5'000'000;    ///< COMMAND while armed, and ABORT.
    std::int64_t idle_period_ns = 20'000'000;
    std::int64_t hello_period_ns = 50'000'000;
    std::int64_t order_timeout_ns = 1'000'000'000;
    std::int64_t resend_after_ns = 15'000'000;  ///< Without progress; three status periods.
    std::int64_t prefill_ns = 300'000'000;
    std::uint32_t mark_every = 16;  ///< Points between two marks.
    std::uint32_t points_per_poll = 8;
    std::uint32_t window_points = 16;  ///< Sent and not acknowledged: what a slow bus can queue.
    std::uint32_t dictionary_crc = kDictionaryCrc;  ///< 0 accepts any.
  };

  /// Counters since make(); they only rise.
  struct Report {
    std::uint64_t statuses = 0;
    std::uint64_t damaged = 0;
    std::uint64_t repeated = 0;
    std::uint64_t out_of_sequence = 0;
    std::uint64_t malformed = 0;
    std::uint64_t foreign_session = 0;
    std::uint64_t points_sent = 0;
    std::uint64_t points_resent = 0;
    std::uint64_t nacks = 0;
    std::uint64_t trips = 0;
  };

  /// Errors:  kInvalidArgument: a limit out of range.
  [[nodiscard]] static Result<Sender> make(const Config& config) noexcept;

  /// `session`: never 0 and never used before; take it from a good source of randomness.
  Result<> connect(std::uint32_t session, std::int64_t now_ns) noexcept;
  Result<> arm(std::int64_t now_ns) noexcept;
  /// Looks at all points while nothing is armed, so that no cycle of an armed link has to.
  ///
  /// Errors:  as load().
  Result<> expect(trajectory::SetPointView points) noexcept;
  /// Errors:  kInvalidArgument: no points, times that do not rise or come faster than the robot
  ///          takes them, a value that is not finite or does not fit.
  Result<> load(trajectory::SetPointView points, std::uint16_t trajectory,
                std::int64_t now_ns) noexcept;
  Result<> start(std::int64_t now_ns) noexcept;
  /// Stops on the path with the arc off; start() goes on, without the arc until the permit is
  /// withdrawn and given again.
  Result<> hold(std::int64_t now_ns) noexcept;
  /// Controlled stop with the arc off, then disarmed.
  Result<> stop(std::int64_t now_ns) noexcept;
  /// Safe state now, whatever the state was.
  void abort(Fault reason, std::int64_t now_ns) noexcept;
  void permit_weld(bool permit) noexcept;

  DSEAM_NONBLOCKING void on_frame(const Frame& frame, std::int64_t now_ns) noexcept;
  DSEAM_NONBLOCKING void poll(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void bus_lost(std::int64_t now_ns) noexcept;

  [[nodiscard]] HostState state() const noexcept { return state_; }
  [[nodiscard]] bool armed() const noexcept {
    return state_ >= HostState::kArmed && state_ <= HostState::kDone;
  }
  [[nodiscard]] Fault fault() const noexcept { return fault_; }
  /// Why the robot went to its safe state, where it did.
  [[nodiscard]] Fault peer_fault() const noexcept { return status_.fault; }
  [[nodiscard]] const Status& status() const noexcept { return status_; }
  [[nodiscard]] const Hello& peer() const noexcept { return peer_; }
  [[nodiscard]] const PoseReport& pose() const noexcept { return pose_; }
  /// Points executed of those loaded.
  [[nodiscard]] std::uint32_t executed() const noexcept { return stream_.executed(); }
  /// Host time minus robot time, the least seen in this session: late by the shortest transit.
  [[nodiscard]] std::int64_t clock_offset_ns() const noexcept { return clock_offset_ns_; }
  [[nodiscard]] const Report& report() const noexcept { return report_; }

 private:
  static constexpr std::uint32_t kLeastPrefillPoints = 30;

  explicit Sender(const Config& config) noexcept
      : config_(config), transmitter_(config.addressing), acceptor_(config.addressing) {}

  bool count_status(E2eStatus status) noexcept;
  void dispatch(const Accepted& accepted, std::int64_t now_ns) noexcept;
  void on_hello(const Frame& frame, std::int64_t now_ns) noexcept;
  void on_status(const Frame& frame, std::int64_t now_ns) noexcept;
  void on_nack(const Frame& frame, std::int64_t now_ns) noexcept;
  void on_pose(const Frame& frame) noexcept;
  void follow_peer(std::int64_t now_ns) noexcept;
  void follow_peer_in_motion(std::int64_t now_ns) noexcept;

  Result<> order(bool allowed, HostState next, std::int64_t now_ns) noexcept;
  void enter(HostState next, std::int64_t now_ns) noexcept;
  void trip(Fault fault, std::int64_t now_ns) noexcept;
  void keep_duties(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool fits_peer(trajectory::SetPointView points) const noexcept;
  [[nodiscard]] Request request() const noexcept;
  [[nodiscard]] bool waiting() const noexcept;

  void send_abort(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void send_command(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void send_hello(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void send_trajectory(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  void send_announcement(std::int64_t now_ns, Buffer<Frame>& out) noexcept;
  bool send_point(Buffer<Frame>& out) noexcept;
  void resend_if_stuck(std::int64_t now_ns, Buffer<Frame>& out) noexcept;

  Config config_;
  Transmitter transmitter_;
  Acceptor acceptor_;
  PointStream stream_;
  Report report_;

  HostState state_ = HostState::kOffline;
  Fault fault_ = Fault::kNone;
  std::uint32_t session_ = 0;
  bool greeted_ = false;
  bool permit_ = false;
  Hello peer_;
  trajectory::SetPointView expected_;  ///< Fits this peer.
  Status status_;
  PoseReport pose_;
  std::int64_t clock_offset_ns_ = std::numeric_limits<std::int64_t>::max();

  std::int64_t entered_ns_ = 0;
  std::int64_t last_poll_ns_ = 0;
  std::int64_t last_status_ns_ = 0;
  std::int64_t next_command_ns_ = 0;
  std::int64_t next_hello_ns_ = 0;
  std::int64_t next_begin_ns_ = 0;
  std::int64_t next_abort_ns_ = 0;
  std::int64_t progress_ns_ = 0;  ///< When the robot last got further, or was sent to again.
  int aborts_sent_ = 0;
  std::uint64_t last_host_time_us_ = 0;
};

}  // namespace dseam::link
