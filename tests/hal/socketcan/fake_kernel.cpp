// SPDX-License-Identifier: Apache-2.0
#include "hal/socketcan/fake_kernel.hpp"

#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "support/allocation_counter.hpp"

namespace dseam::test {

int FakeKernel::fails() {
  const int call = calls_++;
  const bool now =
      sabotage_.call >= 0 && (sabotage_.for_ever ? call >= sabotage_.call : call == sabotage_.call);
  sabotaged_ += now ? 1U : 0U;
  return now ? -sabotage_.error : 0;
}

void FakeKernel::set_up(bool up) {
  if (up_ && !up) {
    stuck_frames_.clear();
    for (auto& [fd, socket] : sockets_) {
      socket.pending_error = ENETDOWN;
    }
  }
  up_ = up;
}

void FakeKernel::remove() {
  present_ = false;
  stuck_frames_.clear();
  for (auto& [fd, socket] : sockets_) {
    socket.bound = false;
  }
}

void FakeKernel::report_error(std::uint32_t what, std::uint8_t controller_status) {
  Message message;
  message.frame.can_id = CAN_ERR_FLAG | what;
  message.frame.len = CAN_ERR_DLC;
  message.frame.data[1] = controller_status;
  message.size = CAN_MTU;
  deliver(message, -1);
}

void FakeKernel::inject(const canfd_frame& frame, std::size_t size) {
  deliver({frame, size, 0}, -1);
}

bool FakeKernel::wants(const Socket& socket, const Message& message) {
  if (!socket.bound) {
    return false;
  }
  if ((message.frame.can_id & CAN_ERR_FLAG) != 0 && message.size == CAN_MTU) {
    return socket.errors;
  }
  const bool passes =
      socket.filters.empty() ||
      std::ranges::any_of(socket.filters, [&message](const can_filter& filter) {
        return (message.frame.can_id & filter.can_mask) == (filter.can_id & filter.can_mask);
      });
  return socket.frames && passes && (socket.fd_frames || message.size != CANFD_MTU);
}

void FakeKernel::deliver(const Message& message, int from) {
  const AllocationCounter counter;
  for (auto& [fd, socket] : sockets_) {
    const bool own = fd == from;
    if (!wants(socket, message) || (own && !socket.own)) {
      continue;
    }
    if (socket.inbox.size() >= receive_room_) {
      ++socket.dropped;
      continue;
    }
    socket.inbox.push_back(message);
    socket.inbox.back().flags = own ? MSG_DONTROUTE | MSG_CONFIRM : MSG_DONTROUTE;
  }
  allocations_ += counter.count();
}

int FakeKernel::open_socket(int, int, int) noexcept {
  if (const int error = fails(); error != 0) {
    return error;
  }
  sockets_[next_fd_] = Socket{};
  return next_fd_++;
}

int FakeKernel::set_option(int fd, int level, int option, const void* value,
                           socklen_t size) noexcept {
  if (const int error = fails(); error != 0) {
    return error;
  }
  Socket& socket = sockets_.at(fd);
  if (level != SOL_CAN_RAW) {
    return 0;
  }
  if (option == CAN_RAW_FD_FRAMES) {
    socket.fd_frames = true;
  } else if (option == CAN_RAW_RECV_OWN_MSGS) {
    socket.own = true;
  } else if (option == CAN_RAW_ERR_FILTER) {
    socket.errors = true;
  } else if (option == CAN_RAW_FILTER) {
    socket.frames = size > 0;
    socket.filters.resize(size / sizeof(can_filter));
    if (size > 0) {
      std::memcpy(socket.filters.data(), value, size);
    }
  }
  return 0;
}

int FakeKernel::bind_socket(int fd, const sockaddr*, socklen_t) noexcept {
  const int error = fails();
  sockets_.at(fd).bound = error == 0;
  return error;
}

int FakeKernel::control(int fd, unsigned long request, void* argument) noexcept {
  if (const int error = fails(); error != 0) {
    return error;
  }
  if (!sockets_.contains(fd)) {
    return -EBADF;
  }
  if (!present_) {
    return -ENODEV;
  }
  auto* answer = static_cast<ifreq*>(argument);
  if (request == SIOCGIFMTU) {
    answer->ifr_mtu = fd_ ? CANFD_MTU : CAN_MTU;
  } else if (request == SIOCGIFFLAGS) {
    answer->ifr_flags = static_cast<short>(up_ ? IFF_UP : 0);
  } else {
    answer->ifr_ifindex = 7;
  }
  return 0;
}

std::int64_t FakeKernel::send_bytes(int fd, const void* bytes, std::size_t size) noexcept {
  if (const int error = fails(); error != 0) {
    return error;
  }
  if (!sockets_.contains(fd)) {
    return -EBADF;
  }
  if (!sockets_.at(fd).bound) {
    return -ENXIO;
  }
  if (!up_) {
    return -ENETDOWN;
  }
  Message message;
  std::memcpy(&message.frame, bytes, size);
  message.size = size;
  if (stuck_) {
    if (stuck_frames_.size() >= room_) {
      return -ENOBUFS;
    }
    stuck_frames_.emplace_back(message, fd);
    return static_cast<std::int64_t>(size);
  }
  for (; !stuck_frames_.empty(); stuck_frames_.pop_front()) {
    deliver(stuck_frames_.front().first, stuck_frames_.front().second);
  }
  deliver(message, fd);
  return static_cast<std::int64_t>(size);
}

std::int64_t FakeKernel::receive_message(int fd, msghdr* message) noexcept {
  if (const int error = fails(); error != 0) {
    return error;
  }
  if (!sockets_.contains(fd)) {
    return -EBADF;
  }
  Socket& socket = sockets_.at(fd);
  if (const int error = socket.pending_error; error != 0) {
    socket.pending_error = 0;
    return -error;
  }
  if (!socket.bound) {
    return -ENODEV;
  }
  if (socket.inbox.empty()) {
    return -EAGAIN;
  }
  const Message next = socket.inbox.front();
  socket.inbox.pop_front();
  const std::size_t size = std::min(next.size, message->msg_iov[0].iov_len);
  std::memcpy(message->msg_iov[0].iov_base, &next.frame, size);
  message->msg_flags = next.flags;
  if (message->msg_control != nullptr && socket.dropped > 0) {
    cmsghdr* part = CMSG_FIRSTHDR(message);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SO_RXQ_OVFL;
    part->cmsg_len = CMSG_LEN(sizeof(socket.dropped));
    std::memcpy(CMSG_DATA(part), &socket.dropped, sizeof(socket.dropped));
    message->msg_controllen = part->cmsg_len;
  } else {
    message->msg_controllen = 0;
  }
  return static_cast<std::int64_t>(size);
}

int FakeKernel::poll_fds(pollfd*, nfds_t, int timeout_ms) noexcept {
  now_ns_ += std::max(timeout_ms, 0) * std::int64_t{1'000'000} + 10'000;
  return fails();
}

int FakeKernel::close_fd(int fd) noexcept {
  sockets_.erase(fd);
  return fails();
}

}  // namespace dseam::test
