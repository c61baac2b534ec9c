// SPDX-License-Identifier: Apache-2.0
#include "device/control_line.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace dseam::hal::aravis {
namespace {

/// Linux answers ENOTCONN for a socket without a peer, and cuts it all the same.
void end_sending(int fd) noexcept { (void)shutdown(fd, SHUT_WR); }

}  // namespace

void ControlLine::hold_the_new_one(std::span<const OwnSocket> before) {
  auto sockets = own_udp_sockets();
  std::erase_if(sockets, [&](const OwnSocket& socket) {
    return std::ranges::find(before, socket.cookie, &OwnSocket::cookie) != before.end();
  });
  release();
  const std::lock_guard lock(mutex_);
  fd_ = sockets.size() == 1 ? fcntl(sockets.front().fd, F_DUPFD_CLOEXEC, 0) : -1;
  if (cut_) {
    end_sending(fd_);
  }
}

void ControlLine::release() noexcept {
  const std::lock_guard lock(mutex_);
  if (fd_ >= 0) {
    close(fd_);
    fd_ = -1;
  }
}

void ControlLine::cut() noexcept {
  const std::lock_guard lock(mutex_);
  cut_ = true;
  end_sending(fd_);
}

}  // namespace dseam::hal::aravis
