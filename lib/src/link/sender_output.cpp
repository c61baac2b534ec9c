// SPDX-License-Identifier: Apache-2.0
// The host's duties in time, and what goes out: abort, heartbeat, trajectory, greeting.
#include <algorithm>

#include "dseam/link/codec.hpp"
#include "dseam/link/sender.hpp"

namespace dseam::link {
namespace {

constexpr int kLeastAborts = 3;
constexpr std::int64_t kNsPerUs = 1000;

}  // namespace

Request Sender::request() const noexcept {
  switch (state_) {
    case HostState::kConnecting:
      return greeted_ && status_.state == RobotState::kSafe ? Request::kReset : Request::kIdle;
    case HostState::kArming:
    case HostState::kArmed:
    case HostState::kDone:
      return Request::kArm;
    case HostState::kLoading:
    case HostState::kReady:
      return Request::kLoad;
    case HostState::kStarting:
    case HostState::kRunning:
      return Request::kStart;
    case HostState::kHold:
      return Request::kHold;
    case HostState::kStopping:
      return Request::kStop;
    case HostState::kOffline:
    case HostState::kIdle:
    case HostState::kSafe:
      break;
  }
  return Request::kIdle;
}

/// States that the robot has to answer with one of its own.
bool Sender::waiting() const noexcept {
  return state_ == HostState::kConnecting || state_ == HostState::kArming ||
         state_ == HostState::kStarting || state_ == HostState::kStopping;
}

void Sender::keep_duties(std::int64_t now_ns) noexcept {
  if (armed() && now_ns - last_poll_ns_ > config_.silence_limit_ns) {
    trip(Fault::kOverrun, now_ns);  // The robot has stopped by itself; do not pretend otherwise.
  } else if (armed() && now_ns - last_status_ns_ > config_.silence_limit_ns) {
    trip(Fault::kStatusSilent, now_ns);
  } else if (waiting() && now_ns - entered_ns_ > config_.order_timeout_ns) {
    const bool nobody = state_ == HostState::kConnecting && !greeted_;
    trip(nobody ? Fault::kNoPeer : Fault::kRefused, now_ns);
  }
  last_poll_ns_ = now_ns;
}

void Sender::poll(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  keep_duties(now_ns);
  if (state_ == HostState::kOffline) {
    return;
  }
  send_abort(now_ns, out);
  send_command(now_ns, out);
  send_trajectory(now_ns, out);
  send_hello(now_ns, out);
}

void Sender::send_abort(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  const bool seen = status_.session == session_ &&
                    (status_.state == RobotState::kSafe || status_.state == RobotState::kIdle);
  if (state_ != HostState::kSafe || !greeted_ || now_ns < next_abort_ns_ ||
      (seen && aborts_sent_ >= kLeastAborts)) {
    return;
  }
  Abort abort;
  abort.session = session_;
  abort.reason = fault_;
  if (transmitter_.send(MessageId::kAbort, encode(abort), out)) {
    ++aborts_sent_;
    next_abort_ns_ = now_ns + config_.armed_period_ns;
  }
}

void Sender::send_command(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (!greeted_ || now_ns < next_command_ns_) {
    return;
  }
  Command command;
  command.session = session_;
  command.request = request();
  command.weld_permit = permit_;
  command.trajectory = stream_.trajectory();
  command.host_time_us =
      std::max(last_host_time_us_ + 1, static_cast<std::uint64_t>(now_ns / kNsPerUs));
  if (transmitter_.send(MessageId::kCommand, encode(command), out)) {
    last_host_time_us_ = command.host_time_us;
    const bool often = armed() || state_ == HostState::kArming;
    next_command_ns_ = now_ns + (often ? config_.armed_period_ns : config_.idle_period_ns);
  }
}

void Sender::send_hello(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (state_ != HostState::kConnecting || greeted_ || now_ns < next_hello_ns_) {
    return;
  }
  Hello hello;
  hello.session = session_;
  hello.version = kProtocolVersion;
  hello.dictionary_crc = config_.dictionary_crc;
  hello.silence_limit_ms = static_cast<std::uint8_t>(config_.silence_limit_ns / 1'000'000);
  if (transmitter_.send(MessageId::kHelloHost, encode(hello), out)) {
    next_hello_ns_ = now_ns + config_.hello_period_ns;
  }
}

void Sender::send_trajectory(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (state_ < HostState::kLoading || state_ > HostState::kHold) {
    return;
  }
  if (status_.trajectory != stream_.trajectory()) {
    send_announcement(now_ns, out);
    return;
  }
  resend_if_stuck(now_ns, out);
  for (std::uint32_t i = 0; i < config_.points_per_poll && stream_.may_send(config_.window_points);
       ++i) {
    if (!send_point(out)) {
      return;
    }
  }
}

void Sender::send_announcement(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  if (now_ns >= next_begin_ns_ &&
      transmitter_.send(MessageId::kTrajectory, encode(stream_.announcement()), out)) {
    next_begin_ns_ = now_ns + config_.resend_after_ns;
    progress_ns_ = now_ns;
  }
}

bool Sender::send_point(Buffer<Frame>& out) noexcept {
  const Frame payload = stream_.point();
  if (!transmitter_.send(MessageId::kPoint, payload, out)) {
    return false;
  }
  stream_.sent(payload);
  ++report_.points_sent;
  const bool mark = stream_.next() % config_.mark_every == 0 || stream_.next() == stream_.size();
  // A mark that finds no room is repeated by resend_if_stuck().
  return !mark || transmitter_.send(MessageId::kTrajectory, encode(stream_.mark_sent()), out);
}

void Sender::resend_if_stuck(std::int64_t now_ns, Buffer<Frame>& out) noexcept {
  const bool outstanding = stream_.confirmed() < stream_.next();
  if (!outstanding) {
    progress_ns_ = now_ns;
  }
  if (now_ns - progress_ns_ < config_.resend_after_ns) {
    return;
  }
  progress_ns_ = now_ns;
  report_.points_resent += stream_.go_back();
  if (stream_.confirmed() < stream_.acknowledged()) {
    static_cast<void>(
        transmitter_.send(MessageId::kTrajectory, encode(stream_.mark_acknowledged()), out));
  }
}

}  // namespace dseam::link
