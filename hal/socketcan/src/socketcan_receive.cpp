// SPDX-License-Identifier: Apache-2.0
#include <linux/can.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "dseam/hal/socketcan/socketcan_bus.hpp"

namespace dseam::hal::socketcan {
namespace {

/// Own frames, error frames and damage passed over in one call at most.
constexpr int kMostPassedOver = 256;
constexpr int kMostErrors = 32;
constexpr std::int64_t kNsPerMs = 1'000'000;

/// The kernel's counter of frames it had no room for, where the message carries one.
std::uint32_t dropped_in(const msghdr& message) noexcept {
  auto* header = const_cast<msghdr*>(&message);  // NOLINT: CMSG_NXTHDR does not take const.
  std::uint32_t dropped = 0;
  for (cmsghdr* part = CMSG_FIRSTHDR(header); part != nullptr; part = CMSG_NXTHDR(header, part)) {
    if (part->cmsg_level == SOL_SOCKET && part->cmsg_type == SO_RXQ_OVFL) {
      std::memcpy(&dropped, CMSG_DATA(part), sizeof(dropped));
    }
  }
  return dropped;
}

}  // namespace

Result<CanFrame> SocketCanBus::do_receive(std::chrono::nanoseconds timeout) noexcept {
  const std::int64_t deadline_ns = sys_.now_ns() + timeout.count();
  while (true) {
    std::int64_t now_ns = sys_.now_ns();
    {
      const std::lock_guard lock(mutex_);
      read_errors();
      if (!usable(now_ns)) {
        return Errc::kDisconnected;
      }
      const Result<CanFrame> frame = read_frame(now_ns);
      pump(now_ns);
      if (frame.ok() || frame.error() != Errc::kTimeout) {
        return frame;
      }
    }
    now_ns = sys_.now_ns();
    if (now_ns >= deadline_ns) {
      return Errc::kTimeout;
    }
    wait(deadline_ns - now_ns);
  }
}

/// At most a millisecond: what waits in our own queue must get its turn meanwhile.
void SocketCanBus::wait(std::int64_t timeout_ns) noexcept {
  pollfd fds[2] = {{frames_.fd(), POLLIN, 0}, {errors_.fd(), POLLIN, 0}};
  const bool short_wait = timeout_ns < kNsPerMs;
  static_cast<void>(sys_.poll_fds(fds, 2, short_wait ? 0 : 1));
}

Result<CanFrame> SocketCanBus::read_frame(std::int64_t now_ns) noexcept {
  for (int i = 0; i < kMostPassedOver; ++i) {
    canfd_frame raw{};
    iovec part{&raw, sizeof(raw)};
    alignas(cmsghdr) std::array<char, 64> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const std::int64_t size = sys_.receive_message(frames_.fd(), &message);
    if (size < 0) {
      failed(static_cast<int>(-size), now_ns);
      return presence_ == Presence::kUp ? Errc::kTimeout : Errc::kDisconnected;
    }
    CanFrame frame;
    if (take_in(message, size, raw, frame)) {
      frame.stamp_ns = now_ns;
      ++health_.received;
      return frame;
    }
    last_confirm_ns_ = (message.msg_flags & MSG_CONFIRM) != 0 ? now_ns : last_confirm_ns_;
  }
  return Errc::kTimeout;
}

/// False for what is not another node's frame: our own confirmed one, or damage.
bool SocketCanBus::take_in(const msghdr& message, std::int64_t size, const canfd_frame& raw,
                           CanFrame& frame) noexcept {
  health_.receive_overflow = std::max<std::uint64_t>(health_.receive_overflow, dropped_in(message));
  if ((message.msg_flags & MSG_CONFIRM) != 0) {
    ++health_.confirmed;
    in_kernel_ -= in_kernel_ > 0 ? 1U : 0U;
    return false;
  }
  frame.fd = size == static_cast<std::int64_t>(CANFD_MTU);
  frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  frame.size_bytes = raw.len;
  const bool whole = frame.fd || size == static_cast<std::int64_t>(CAN_MTU);
  const bool data = (raw.can_id & (CAN_RTR_FLAG | CAN_ERR_FLAG)) == 0;
  if (!whole || !data || !is_can_frame(frame)) {
    ++health_.malformed;
    return false;
  }
  std::transform(raw.data, raw.data + raw.len, frame.data.begin(),
                 [](std::uint8_t byte) { return std::byte{byte}; });
  return true;
}

void SocketCanBus::read_errors() noexcept {
  for (int i = 0; i < kMostErrors && presence_ == Presence::kUp; ++i) {
    can_frame raw{};
    iovec part{&raw, sizeof(raw)};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    if (sys_.receive_message(errors_.fd(), &message) != static_cast<std::int64_t>(sizeof(raw))) {
      return;
    }
    if ((raw.can_id & CAN_ERR_FLAG) == 0) {
      ++health_.malformed;
      continue;
    }
    ++health_.error_frames;
    const auto state = count_error(raw, error_counts_);
    health_.state = state.value_or(health_.state);
    if (state == BusState::kBusOff) {
      queue_.clear();
    }
  }
}

}  // namespace dseam::hal::socketcan
