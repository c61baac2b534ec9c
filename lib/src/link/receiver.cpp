// SPDX-License-Identifier: Apache-2.0
// What comes in: session, orders and points. receiver_motion.cpp has the path and the duties.
#include "dseam/link/receiver.hpp"

#include <algorithm>

#include "dseam/link/codec.hpp"

namespace dseam::link {
namespace {

constexpr std::int64_t kLeastSilenceNs = 4'000'000;
constexpr std::int64_t kMostSilenceNs = 200'000'000;

bool sensible(const Receiver::Config& config) noexcept {
  return config.silence_limit_ns >= kLeastSilenceNs && config.silence_limit_ns <= kMostSilenceNs &&
         config.armed_period_ns > 0 && config.armed_period_ns < config.silence_limit_ns &&
         config.idle_period_ns > 0 && config.stop_ns > 0 && config.prefill_ns >= config.stop_ns &&
         config.addressing.fits_11_bits();
}

}  // namespace

Result<Receiver> Receiver::make(const Config& config, std::uint16_t capacity_points,
                                Arena& arena) noexcept {
  if (!sensible(config) || capacity_points < 2) {
    return Errc::kInvalidArgument;
  }
  const auto slots = arena.take<PointStore::Slot>(capacity_points);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return Receiver(config, slots);
}

void Receiver::on_frame(const Frame& frame, std::int64_t now_ns) noexcept {
  const std::optional<Accepted> accepted = acceptor_.accept(frame);
  if (!accepted) {
    return;
  }
  if (count_status(*accepted)) {
    dispatch(*accepted, now_ns);
  }
  if (armed() && acceptor_.state(accepted->message) == E2eState::kInvalid) {
    trip(Fault::kE2eInvalid, now_ns);
  }
}

bool Receiver::count_status(const Accepted& accepted) noexcept {
  report_.damaged += accepted.status == E2eStatus::kError ? 1U : 0U;
  report_.repeated += accepted.status == E2eStatus::kRepeated ? 1U : 0U;
  report_.out_of_sequence += accepted.status == E2eStatus::kWrongSequence ? 1U : 0U;
  return usable(accepted.status);
}

void Receiver::dispatch(const Accepted& accepted, std::int64_t now_ns) noexcept {
  switch (accepted.message) {
    case MessageId::kHelloHost:
      return on_hello(accepted.payload);
    case MessageId::kCommand:
      return on_command(accepted.payload, now_ns);
    case MessageId::kAbort:
      return on_abort(accepted.payload, now_ns);
    case MessageId::kTrajectory:
      return on_trajectory(accepted.payload);
    case MessageId::kPoint:
      return on_point(accepted.payload);
    default:
      return;  // Our own messages: a second robot on the bus is seen by its host.
  }
}

void Receiver::on_hello(const Frame& frame) noexcept {
  const Result<Hello> decoded = decode_hello(frame);
  const bool still = state_ == RobotState::kIdle || state_ == RobotState::kSafe;
  if (!decoded.ok() || decoded.value().session == 0) {
    ++report_.malformed;
    return;
  }
  const std::uint32_t session = decoded.value().session;
  if (session != session_ && (!still || used_before(session))) {
    ++report_.foreign_session;  // Armed, or a stale frame of a session that is over.
    return;
  }
  if (session != session_) {
    adopt_session(session);
  }
  ++report_.accepted;
  hello_due_ = true;
}

bool Receiver::used_before(std::uint32_t session) const noexcept {
  return std::ranges::find(sessions_, session) != sessions_.end();
}

void Receiver::adopt_session(std::uint32_t session) noexcept {
  session_ = session;
  sessions_[session_count_++ % kRememberedSessions] = session;
  fresh_session_ = true;
  acceptor_.reset();
  points_.begin(0);
  begun_ = false;
  trajectory_ = 0;
  last_host_time_us_ = 0;
  path_ns_ = 0;
}

void Receiver::on_command(const Frame& frame, std::int64_t now_ns) noexcept {
  const Result<Command> decoded = decode_command(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  const Command& command = decoded.value();
  if (command.session != session_ || session_ == 0) {
    ++report_.foreign_session;
    return armed() ? trip(Fault::kForeignSession, now_ns) : void();
  }
  if (command.host_time_us <= last_host_time_us_) {
    ++report_.out_of_sequence;  // A replay whose counter happened to fit.
    return;
  }
  ++report_.accepted;
  last_host_time_us_ = command.host_time_us;
  last_command_ns_ = now_ns;
  set_permit(command.weld_permit);
  follow(command, now_ns);
}

void Receiver::set_permit(bool permit) noexcept {
  if (permit && !permit_) {
    arc_latched_off_ = false;
  }
  permit_ = permit;
}

void Receiver::follow(const Command& command, std::int64_t now_ns) noexcept {
  if (state_ == RobotState::kRunning || state_ == RobotState::kHold) {
    return follow_while_moving(command.request);
  }
  follow_while_still(command, now_ns);
}

void Receiver::follow_while_moving(Request request) noexcept {
  if (request == Request::kStop || request == Request::kIdle) {
    stop(RobotState::kIdle);
  } else if (request == Request::kHold && state_ == RobotState::kRunning) {
    state_ = RobotState::kHold;
    arc_latched_off_ = true;
    target_rate_ = 0.0;
  } else if (request == Request::kStart && state_ == RobotState::kHold) {
    state_ = RobotState::kRunning;
    target_rate_ = 1.0;
  }
}

void Receiver::follow_while_still(const Command& command, std::int64_t now_ns) noexcept {
  const Request request = command.request;
  const bool disarm = request == Request::kIdle || request == Request::kStop;
  if (state_ == RobotState::kSafe && request == Request::kReset && fresh_session_) {
    state_ = RobotState::kIdle;
    fault_ = Fault::kNone;
  } else if (state_ == RobotState::kIdle && request == Request::kArm) {
    state_ = RobotState::kArmed;
    next_status_ns_ = now_ns;
  } else if (armed() && disarm) {
    stop(RobotState::kIdle);
  } else if (state_ == RobotState::kArmed && request == Request::kLoad &&
             command.trajectory != trajectory_) {
    state_ = RobotState::kLoading;
    trajectory_ = command.trajectory;
    begun_ = false;
    points_.begin(0);
  } else if (state_ == RobotState::kLoading && request == Request::kStart && ready_to_start()) {
    state_ = RobotState::kRunning;
    path_ns_ = 0;
    rate_ = 1.0;
    target_rate_ = 1.0;
    arc_latched_off_ = false;
  }
}

void Receiver::on_abort(const Frame& frame, std::int64_t now_ns) noexcept {
  const Result<Abort> decoded = decode_abort(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  ++report_.accepted;
  trip(Fault::kAborted, now_ns);  // Whatever its session: stopping is safe whoever asks for it.
}

void Receiver::on_trajectory(const Frame& frame) noexcept {
  const Result<TrajectoryMark> decoded = decode_trajectory(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  const TrajectoryMark& mark = decoded.value();
  if (mark.session != session_ || mark.trajectory != trajectory_) {
    ++report_.foreign_session;
    return;
  }
  ++report_.accepted;
  if (mark.kind == TrajectoryKind::kBegin) {
    if (state_ == RobotState::kLoading && !begun_) {
      points_.begin(mark.count);
      begun_ = true;
    }
  } else if (begun_ && points_.confirm(mark.count, mark.crc) == PointStore::Confirm::kMismatch) {
    ++report_.bad_marks;
    ask_again(NackReason::kBadMark);
  }
}

void Receiver::on_point(const Frame& frame) noexcept {
  const Result<Point> decoded = decode_point(frame);
  if (!decoded.ok()) {
    ++report_.malformed;
    return;
  }
  const Point& point = decoded.value();
  if (point.session != session_ || point.trajectory != trajectory_ || !begun_) {
    ++report_.foreign_session;
    return;
  }
  switch (points_.take(point, frame)) {
    case PointStore::Take::kStored:
      ++report_.accepted;
      nack_due_ = false;
      return;
    case PointStore::Take::kRepeated:
      ++report_.out_of_order_points;
      return;
    case PointStore::Take::kGap:
      ++report_.out_of_order_points;
      return ask_again(NackReason::kGap);
    case PointStore::Take::kNoRoom:
      return ask_again(NackReason::kNoRoom);
    case PointStore::Take::kBadMark:
      ++report_.bad_marks;
      return ask_again(NackReason::kBadMark);
    case PointStore::Take::kContradiction:
      ++report_.malformed;
      return ask_again(NackReason::kGap);
  }
}

void Receiver::ask_again(NackReason reason) noexcept {
  nack_due_ = true;
  nack_reason_ = reason;
}

}  // namespace dseam::link
