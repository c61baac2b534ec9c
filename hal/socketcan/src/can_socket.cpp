// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/socketcan/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>

namespace dseam::hal::socketcan {

Errc errc_of(int error) noexcept {
  switch (error) {
    case ENODEV:
    case ENXIO:
      return Errc::kNotFound;
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
    case ENOPROTOOPT:
      return Errc::kUnsupported;
    case EPERM:
    case EACCES:
    case EBUSY:
      return Errc::kUnavailable;
    case ENOMEM:
    case ENOBUFS:
    case EMFILE:
    case ENFILE:
      return Errc::kOutOfMemory;
    case ENETDOWN:
      return Errc::kDisconnected;
    default:
      return Errc::kIo;
  }
}

bool CanSocket::remember(std::string_view interface) noexcept {
  if (interface.empty() || interface.size() >= interface_.size()) {
    return false;
  }
  interface_.fill('\0');
  std::ranges::copy(interface, interface_.begin());
  return true;
}

Result<> CanSocket::closed_after(Errc error) noexcept {
  close();
  return error;
}

Result<> CanSocket::open_unbound() noexcept {
  close();
  const int fd = sys_->open_socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd < 0) {
    return errc_of(-fd);
  }
  fd_ = fd;
  return {};
}

Result<> CanSocket::option(int level, int option, const void* value, socklen_t size) noexcept {
  const int set = sys_->set_option(fd_, level, option, value, size);
  return set < 0 ? Result<>(errc_of(-set)) : Result<>();
}

Result<> CanSocket::bind_to_interface() noexcept {
  ifreq request{};
  std::ranges::copy(interface_, request.ifr_name);
  const int found = sys_->control(fd_, SIOCGIFINDEX, &request);
  if (found < 0) {
    return errc_of(-found);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  const auto* generic = reinterpret_cast<const sockaddr*>(&address);  // NOLINT: the API is so.
  const int bound = sys_->bind_socket(fd_, generic, sizeof(address));
  return bound < 0 ? Result<>(errc_of(-bound)) : Result<>();
}

Result<> CanSocket::open_for_frames(std::string_view interface, bool fd,
                                    std::span<const can_filter> filters) noexcept {
  if (!remember(interface)) {
    return Errc::kInvalidArgument;
  }
  if (const auto opened = open_unbound(); !opened.ok()) {
    return opened;
  }
  // SO_SNDBUF is set to the least the kernel grants: only then does poll() wait for real room, and
  // only a handful of frames lie where they cannot be overtaken or taken back.
  const Result<> steps[] = {
      fd ? flag(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) : Result<>(),
      flag(SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1),
      filters.empty() ? Result<>()
                      : option(SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                               static_cast<socklen_t>(filters.size_bytes())),
      flag(SOL_SOCKET, SO_SNDBUF, 0),
      flag(SOL_SOCKET, SO_RXQ_OVFL, 1),
      bind_to_interface(),
  };
  for (const Result<>& step : steps) {
    if (!step.ok()) {
      return closed_after(step.error());
    }
  }
  ifreq request{};
  std::ranges::copy(interface_, request.ifr_name);
  const int read = sys_->control(fd_, SIOCGIFMTU, &request);
  if (read < 0) {
    return closed_after(errc_of(-read));
  }
  return fd && request.ifr_mtu < static_cast<int>(CANFD_MTU) ? closed_after(Errc::kUnsupported)
                                                             : Result<>();
}

Result<> CanSocket::open_for_errors(std::string_view interface) noexcept {
  if (!remember(interface)) {
    return Errc::kInvalidArgument;
  }
  if (const auto opened = open_unbound(); !opened.ok()) {
    return opened;
  }
  const can_err_mask_t all = CAN_ERR_MASK;
  const Result<> steps[] = {
      option(SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0),
      option(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &all, sizeof(all)),
      bind_to_interface(),
  };
  for (const Result<>& step : steps) {
    if (!step.ok()) {
      return closed_after(step.error());
    }
  }
  return {};
}

void CanSocket::close() noexcept {
  if (fd_ >= 0) {
    sys_->close_fd(fd_);
    fd_ = -1;
  }
}

int CanSocket::is_up() noexcept {
  ifreq request{};
  std::ranges::copy(interface_, request.ifr_name);
  const int read = sys_->control(fd_, SIOCGIFFLAGS, &request);
  return read < 0 ? read : ((request.ifr_flags & IFF_UP) != 0 ? 1 : 0);
}

}  // namespace dseam::hal::socketcan
