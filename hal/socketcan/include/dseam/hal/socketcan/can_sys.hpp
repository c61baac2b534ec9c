// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>

namespace dseam::hal::socketcan {

/// Every system call of this backend, so that a test can make the n-th one fail in its real code.
/// Functions return what the system call returns, or -errno.
class CanSys {
 public:
  CanSys() = default;
  CanSys(const CanSys&) = delete;
  CanSys& operator=(const CanSys&) = delete;

  virtual int open_socket(int domain, int type, int protocol) noexcept = 0;
  virtual int set_option(int fd, int level, int option, const void* value,
                         socklen_t size) noexcept = 0;
  virtual int bind_socket(int fd, const sockaddr* address, socklen_t size) noexcept = 0;
  virtual int control(int fd, unsigned long request, void* argument) noexcept = 0;
  virtual std::int64_t send_bytes(int fd, const void* bytes, std::size_t size) noexcept = 0;
  virtual std::int64_t receive_message(int fd, msghdr* message) noexcept = 0;
  virtual int poll_fds(pollfd* fds, nfds_t count, int timeout_ms) noexcept = 0;
  virtual int close_fd(int fd) noexcept = 0;
  virtual std::int64_t now_ns() noexcept = 0;

 protected:
  ~CanSys() = default;
};

/// The kernel's.
[[nodiscard]] CanSys& linux_can_sys() noexcept;

}  // namespace dseam::hal::socketcan
