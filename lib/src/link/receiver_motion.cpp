// SPDX-License-Identifier: Apache-2.0
// What the robot does with time: the path, the duty to stop, and what it reports.
#include <algorithm>

#include "dseam/link/codec.hpp"
#include "dseam/link/receiver.hpp"

namespace dseam::link {
namespace {

constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr std::uint64_t k48Bits = (std::uint64_t{1} << 48U) - 1;

std::uint64_t as_time_us(std::int64_t now_ns) noexcept {
  return static_cast<std::uint64_t>(now_ns / kNsPerUs) & k48Bits;
}

}  // namespace

bool Receiver::armed() const noexcept {
  return state_ == RobotState::kArmed || state_ == RobotState::kLoading ||
         state_ == RobotState::kRunning || state_ == RobotState::kHold;
}

bool Receiver::arc_on() const noexcept {
  return state_ == RobotState::kRunning && permit_ && !arc_latched_off_ && point_arc_;
}

bool Receiver::ready_to_start() const noexcept {
  const bool all = points_.total() > 0 && points_.verified() == points_.total();
  return all || buffered_ns() >= config_.prefill_ns ||
         (points_.free() == 0 && points_.verified() == points_.received());
}

std::int64_t Receiver::buffered_ns() const noexcept {
  return std::max<std::int64_t>(0, points_.verified_until_us() * kNsPerUs - path_ns_);
}

void Receiver::stop(RobotState then) noexcept {
  permit_ = false;
  arc_latched_off_ = true;
  point_arc_ = false;
  after_stop_ = then;
  target_rate_ = 0.0;
  state_ = RobotState::kStopping;
  finish_stop();
}

void Receiver::trip(Fault fault, std::int64_t now_ns) noexcept {
  const bool stopping_already = state_ == RobotState::kStopping && after_stop_ == RobotState::kIdle;
  if (!armed() && !stopping_already) {
    return;
  }
  ++report_.trips;
  fault_ = fault;
  fresh_session_ = false;
  next_status_ns_ = now_ns;
  stop(RobotState::kSafe);
}

/// At rest, or at the end of what may be executed: where a stop ends.
void Receiver::finish_stop() noexcept {
  if (state_ == RobotState::kStopping && (rate_ <= 0.0 || points_.front() == nullptr)) {
    rate_ = 0.0;
    state_ = after_stop_;
  }
}

void Receiver::keep_duties(std::int64_t now_ns) noexcept {
  const bool listening = armed() || state_ == RobotState::kStopping;
  if (listening && now_ns - last_command_ns_ > config_.silence_limit_ns) {
    trip(Fault::kCommandSilent, now_ns);
  }
  const bool more_to_come = points_.verified() < points_.total();
  if (state_ == RobotState::kRunning && more_to_come && buffered_ns() < config_.stop_ns) {
    trip(Fault::kStarved, now_ns);
  }
}

void Receiver::advance_path(std::int64_t now_ns) noexcept {
  const auto elapsed_ns = static_cast<double>(std::max<std::int64_t>(0, now_ns - last_poll_ns_));
  last_poll_ns_ = now_ns;
  if (rate_ == target_rate_) {
    path_ns_ += static_cast<std::int64_t>(elapsed_ns * rate_);
    return;
  }
  // One ramp, up or down: the path's length under it is exact, however late the poll comes.
  const double slope = (target_rate_ > rate_ ? 1.0 : -1.0) / static_cast<double>(config_.stop_ns);
  const double ramp_ns = std::min(elapsed_ns, (target_rate_ - rate_) / slope);
  const double reached = ramp_ns < elapsed_ns ? target_rate_ : rate_ + slope * ramp_ns;
  path_ns_ += static_cast<std::int64_t>(0.5 * (rate_ + reached) * ramp_ns +
                                        reached * (elapsed_ns - ramp_ns));
  rate_ = reached;
}

bool Receiver::take_due(DuePoint& out) noexcept {
  const bool on_path = state_ == RobotState::kRunning || state_ == RobotState::kHold ||
                       state_ == RobotState::kStopping;
  const trajectory::SetPoint* point = on_path ? points_.front() : nullptr;
  if (point == nullptr || point->t_us * kNsPerUs > path_ns_) {
    return false;
  }
  point_arc_ = point->arc;
  out = {session_, trajectory_, points_.executed(), arc_on(), *point};
  points_.pop();
  if (points_.complete() && state_ != RobotState::kStopping) {
    state_ = RobotState::kArmed;
    rate_ = 0.0;
    target_rate_ = 0.0;
    point_arc_ = false;
  }
  finish_stop();
  return true;
}

void Receiver::report_pose(const torch::TorchPose& pose, double speed_mm_s) noexcept {
  pose_.pose = pose;
  pose_.speed_mm_s = speed_mm_s;
  pose_known_ = true;
}

void Receiver::report_condition(const RobotCondition& condition) noexcept {
  if (condition != condition_) {
    condition_ = condition;
    next_status_ns_ = 0;
  }
}

Status Receiver::status(std::int64_t now_ns) const noexcept {
  Status status;
  status.session = session_;
  status.state = state_;
  status.arc_on = arc_on();
  status.ack_seq = static_cast<std::uint16_t>(points_.received());
  status.verified_seq = static_cast<std::uint16_t>(points_.verified());
  status.exec_seq = static_cast<std::uint16_t>(points_.executed());
  status.credit = begun_ ? static_cast<std::uint16_t>(points_.free()) : std::uint16_t{0};
  status.buffer_ms =
      static_cast<std::uint16_t>(std::min<std::int64_t>(buffered_ns() / kNsPerMs, UINT16_MAX));
  status.trajectory = begun_ ? trajectory_ : std::uint16_t{0};
  status.fault = fault_;
  status.robot_time_us = as_time_us(now_ns);
  status.condition = condition_;
  return status;
}

void Receiver::send_nack(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (!nack_due_ || now_ns < next_nack_ns_) {
    return;
  }
  Nack nack;
  nack.session = session_;
  nack.trajectory = trajectory_;
  nack.expected_seq = static_cast<std::uint16_t>(points_.received());
  nack.reason = nack_reason_;
  if (transmitter_.send(MessageId::kNack, encode(nack), out)) {
    nack_due_ = false;
    next_nack_ns_ = now_ns + config_.armed_period_ns;
  }
}

void Receiver::send_pose(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (!pose_known_ || now_ns < next_pose_ns_) {
    return;
  }
  pose_.session = session_;
  pose_.robot_time_us = as_time_us(now_ns);
  pose_.exec_seq = static_cast<std::uint16_t>(points_.executed());
  pose_.arc_on = arc_on();
  const Result<Frame> payload = encode(pose_);
  if (payload.ok() && transmitter_.send(MessageId::kPose, payload.value(), out)) {
    next_pose_ns_ = now_ns + config_.idle_period_ns;
  }
}

void Receiver::poll(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  keep_duties(now_ns);
  advance_path(now_ns);
  finish_stop();
  const bool quiet = state_ == RobotState::kIdle || state_ == RobotState::kSafe;
  if (now_ns >= next_status_ns_ &&
      transmitter_.send(MessageId::kStatus, encode(status(now_ns)), out)) {
    next_status_ns_ = now_ns + (quiet ? config_.idle_period_ns : config_.armed_period_ns);
  }
  send_nack(now_ns, out);
  send_pose(now_ns, out);
  if (hello_due_) {
    Hello hello;
    hello.session = session_;
    hello.version = kProtocolVersion;
    hello.dictionary_crc = config_.dictionary_crc;
    hello.buffer_points = static_cast<std::uint16_t>(points_.capacity());
    hello.min_period_us = config_.min_period_us;
    hello.max_speed_mm_s = config_.max_speed_mm_s;
    hello.silence_limit_ms = static_cast<std::uint8_t>(config_.silence_limit_ns / kNsPerMs);
    hello_due_ = !transmitter_.send(MessageId::kHelloRobot, encode(hello), out);
  }
}

}  // namespace dseam::link
