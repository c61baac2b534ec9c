// SPDX-License-Identifier: Apache-2.0
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

#include "dseam/hal/socketcan/can_sys.hpp"

namespace dseam::hal::socketcan {
namespace {

template <typename Number>
Number or_error(Number result) noexcept {
  return result < 0 ? static_cast<Number>(-errno) : result;
}

class LinuxCanSys final : public CanSys {
 public:
  int open_socket(int domain, int type, int protocol) noexcept override {
    return or_error(::socket(domain, type, protocol));
  }
  int set_option(int fd, int level, int option, const void* value,
                 socklen_t size) noexcept override {
    return or_error(::setsockopt(fd, level, option, value, size));
  }
  int bind_socket(int fd, const sockaddr* address, socklen_t size) noexcept override {
    return or_error(::bind(fd, address, size));
  }
  int control(int fd, unsigned long request, void* argument) noexcept override {
    return or_error(::ioctl(fd, request, argument));
  }
  std::int64_t send_bytes(int fd, const void* bytes, std::size_t size) noexcept override {
    return or_error(::send(fd, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL));
  }
  std::int64_t receive_message(int fd, msghdr* message) noexcept override {
    return or_error(::recvmsg(fd, message, MSG_DONTWAIT));
  }
  int poll_fds(pollfd* fds, nfds_t count, int timeout_ms) noexcept override {
    return or_error(::poll(fds, count, timeout_ms));
  }
  int close_fd(int fd) noexcept override { return or_error(::close(fd)); }
  std::int64_t now_ns() noexcept override {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  }
};

}  // namespace

CanSys& linux_can_sys() noexcept {
  static LinuxCanSys sys;
  return sys;
}

}  // namespace dseam::hal::socketcan
