// SPDX-License-Identifier: Apache-2.0
// Orders and what comes in. sender_output.cpp has the duties and what goes out.
#include "dseam/link/sender.hpp"

#include <algorithm>

#include "dseam/link/codec.hpp"

namespace dseam::link {
namespace {

constexpr std::int64_t kLeastSilenceNs = 4'000'000;
constexpr std::int64_t kMostSilenceNs = 200'000'000;
constexpr std::uint32_t kMostPointsUnderWayClassic = 4;

bool sensible(const Sender::Config& config) noexcept {
  return config.silence_limit_ns >= kLeastSilenceNs && config.silence_limit_ns <= kMostSilenceNs &&
         config.armed_period_ns > 0 && config.armed_period_ns < config.silence_limit_ns &&
         config.idle_period_ns > 0 && config.hello_period_ns > 0 && config.order_timeout_ns > 0 &&
         config.resend_after_ns > 0 && config.mark_every > 0 && config.points_per_poll > 0 &&
         config.window_points > 0 && config.addressing.fits_11_bits();
}

bool at_rest(RobotState state) noexcept {
  return state == RobotState::kSafe || state == RobotState::kFault || state == RobotState::kIdle;
}

}  // namespace

Result<Sender> Sender::make(const Config& config) noexcept {
  if (!sensible(config)) {
    return Errc::kInvalidArgument;
  }
  Config paced = config;
  if (config.addressing.classic) {
    // A point takes eight frames of the queue there.
    paced.window_points = std::min(config.window_points, kMostPointsUnderWayClassic);
  }
  return Sender(paced);
}

Result<> Sender::connect(std::uint32_t session, std::int64_t now_ns) noexcept {
  if (session == 0 || session == session_) {
    return Errc::kInvalidArgument;
  }
  if (armed() || state_ == HostState::kArming) {
    return Errc::kUnavailable;
  }
  session_ = session;
  acceptor_.reset();
  status_ = Status{};
  fault_ = Fault::kNone;
  greeted_ = false;
  permit_ = false;
  clock_offset_ns_ = std::numeric_limits<std::int64_t>::max();
  next_hello_ns_ = now_ns;
  enter(HostState::kConnecting, now_ns);
  return {};
}

Result<> Sender::order(bool allowed, HostState next, std::int64_t now_ns) noexcept {
  if (!allowed) {
    return Errc::kUnavailable;
  }
  enter(next, now_ns);
  return {};
}

void Sender::enter(HostState next, std::int64_t now_ns) noexcept {
  state_ = next;
  entered_ns_ = now_ns;
  next_command_ns_ = now_ns;  // A new order leaves with the next poll.
}

Result<> Sender::arm(std::int64_t now_ns) noexcept {
  return order(state_ == HostState::kIdle, HostState::kArming, now_ns);
}

Result<> Sender::expect(trajectory::SetPointView points) noexcept {
  if (points.empty() || !PointStream::encodable(points) || !fits_peer(points)) {
    return Errc::kInvalidArgument;
  }
  expected_ = points;
  return {};
}

Result<> Sender::load(trajectory::SetPointView points, std::uint16_t trajectory,
                      std::int64_t now_ns) noexcept {
  if (state_ != HostState::kArmed && state_ != HostState::kDone) {
    return Errc::kUnavailable;
  }
  const bool new_id = trajectory != 0 && trajectory != status_.trajectory;
  const bool known = points.data() == expected_.data() && points.size() == expected_.size();
  if (!new_id || points.empty() || (!known && !expect(points).ok())) {
    return Errc::kInvalidArgument;
  }
  stream_.begin(points, session_, trajectory);
  next_begin_ns_ = now_ns;
  progress_ns_ = now_ns;
  enter(HostState::kLoading, now_ns);
  return {};
}

bool Sender::fits_peer(trajectory::SetPointView points) const noexcept {
  const double most = peer_.max_speed_mm_s;
  const bool slow_enough = most <= 0.0 || std::ranges::all_of(points, [most](const auto& point) {
                             return point.speed_mm_s <= most;
                           });
  const std::uint32_t least_us = peer_.min_period_us;
  const auto too_close = std::ranges::adjacent_find(
      points, [least_us](const auto& a, const auto& b) { return b.t_us - a.t_us < least_us; });
  return slow_enough && too_close == points.end();
}

Result<> Sender::start(std::int64_t now_ns) noexcept {
  return order(state_ == HostState::kReady || state_ == HostState::kHold, HostState::kStarting,
               now_ns);
}

Result<> Sender::hold(std::int64_t now_ns) noexcept {
  return order(state_ == HostState::kRunning, HostState::kHold, now_ns);
}

Result<> Sender::stop(std::int64_t now_ns) noexcept {
  const Result<> ordered = order(armed(), HostState::kStopping, now_ns);
  permit_ = permit_ && !ordered.ok();
  return ordered;
}

void Sender::abort(Fault reason, std::int64_t now_ns) noexcept { trip(reason, now_ns); }

void Sender::permit_weld(bool permit) noexcept {
  permit_ = permit && armed() && state_ != HostState::kStopping;
  next_command_ns_ = last_poll_ns_;
}

void Sender::bus_lost(std::int64_t now_ns) noexcept {
  if (state_ != HostState::kOffline) {
    trip(Fault::kBusLost, now_ns);
  }
}

void Sender::trip(Fault fault, std::int64_t now_ns) noexcept {
  if (state_ == HostState::kSafe) {
    return;  // The first fault is the one to name.
  }
  ++report_.trips;
  fault_ = fault;
  permit_ = false;
  aborts_sent_ = 0;
  next_abort_ns_ = now_ns;
  enter(HostState::kSafe, now_ns);
}

void Sender::on_frame(const Frame& frame, std::int64_t now_ns) noexcept {
  const std::optional<Accepted> accepted = acceptor_.accept(frame);
  if (!accepted) {
    return;
  }
  if (count_status(accepted->status)) {
    dispatch(*accepted, now_ns);
  }
  if (armed() && acceptor_.state(MessageId::kStatus) == E2eState::kInvalid) {
    trip(Fault::kE2eInvalid, now_ns);
  }
}

bool Sender::count_status(E2eStatus status) noexcept {
  report_.damaged += status == E2eStatus::kError ? 1U : 0U;
  report_.repeated += status == E2eStatus::kRepeated ? 1U : 0U;
  report_.out_of_sequence += status == E2eStatus::kWrongSequence ? 1U : 0U;
  return usable(status);
}

void Sender::dispatch(const Accepted& accepted, std::int64_t now_ns) noexcept {
  switch (accepted.message) {
    case MessageId::kHelloRobot:
      return on_hello(accepted.payload, now_ns);
    case MessageId::kStatus:
      return on_status(accepted.payload, now_ns);
    case MessageId::kNack:
      return on_nack(accepted.payload, now_ns);
    case MessageId::kPose:
      return on_pose(accepted.payload);
    default:
      return;  // Our own messages, seen back from the bus.
  }
}

void Sender::on_hello(const Frame& frame, std::int64_t now_ns) noexcept {
  const Result<Hello> decoded = decode_hello(frame);
  if (!decoded.ok() || decoded.value().session != session_) {
    ++report_.foreign_session;
    return;
  }
  if (state_ != HostState::kConnecting) {
    return;
  }
  peer_ = decoded.value();
  expected_ = {};
  const bool same_words = config_.dictionary_crc == 0 || peer_.dictionary_crc == 0 ||
                          peer_.dictionary_crc == config_.dictionary_crc;
  if (peer_.version != kProtocolVersion || !same_words) {
    return trip(Fault::kIncompatible, now_ns);
  }
  greeted_ = true;
}

void Sender::on_status(const Frame& frame, std::int64_t now_ns) noexcept {
  const Result<Status> decoded = decode_status(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  const Status& status = decoded.value();
  if (status.session != session_ || session_ == 0) {
    ++report_.foreign_session;
    return;
  }
  if (status.robot_time_us <= status_.robot_time_us) {
    ++report_.out_of_sequence;  // A replay whose counter happened to fit.
    return;
  }
  ++report_.statuses;
  status_ = status;
  last_status_ns_ = now_ns;
  clock_offset_ns_ =
      std::min(clock_offset_ns_, now_ns - static_cast<std::int64_t>(status.robot_time_us) * 1000);
  if (status.trajectory == stream_.trajectory() && stream_.on_status(status)) {
    progress_ns_ = now_ns;
  }
  follow_peer(now_ns);
}

void Sender::follow_peer(std::int64_t now_ns) noexcept {
  const RobotState robot = status_.state;
  if (armed() && state_ != HostState::kStopping &&
      (robot == RobotState::kStopping || at_rest(robot))) {
    return trip(Fault::kPeerFault, now_ns);  // It left the armed states without being told to.
  }
  if (state_ == HostState::kConnecting && greeted_ && robot == RobotState::kIdle) {
    enter(HostState::kIdle, now_ns);
  } else if (state_ == HostState::kArming && robot == RobotState::kArmed) {
    enter(HostState::kArmed, now_ns);
  } else if (state_ == HostState::kStopping && at_rest(robot)) {
    enter(HostState::kIdle, now_ns);
    if (robot != RobotState::kIdle) {
      trip(Fault::kPeerFault, now_ns);
    }
  } else {
    follow_peer_in_motion(now_ns);
  }
}

void Sender::follow_peer_in_motion(std::int64_t now_ns) noexcept {
  const bool ours = status_.trajectory == stream_.trajectory();
  const bool finished = ours && status_.state == RobotState::kArmed && stream_.size() > 0 &&
                        stream_.executed() == stream_.size();
  const bool in_motion =
      state_ == HostState::kStarting || state_ == HostState::kRunning || state_ == HostState::kHold;
  if (state_ == HostState::kLoading && ours &&
      stream_.confirmed() >= stream_.count_within(config_.prefill_ns, kLeastPrefillPoints)) {
    enter(HostState::kReady, now_ns);
  } else if (in_motion && finished) {
    enter(HostState::kDone, now_ns);
  } else if (state_ == HostState::kStarting && status_.state == RobotState::kRunning) {
    enter(HostState::kRunning, now_ns);
  }
}

void Sender::on_nack(const Frame& frame, std::int64_t now_ns) noexcept {
  const Result<Nack> decoded = decode_nack(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  const Nack& nack = decoded.value();
  if (nack.session != session_ || nack.trajectory != stream_.trajectory()) {
    ++report_.foreign_session;
    return;
  }
  ++report_.nacks;
  progress_ns_ = now_ns;
  report_.points_resent += stream_.on_nack(nack.expected_seq);
}

void Sender::on_pose(const Frame& frame) noexcept {
  const Result<PoseReport> decoded = decode_pose(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
  } else if (decoded.value().session == session_) {
    pose_ = decoded.value();
  }
}

}  // namespace dseam::link
