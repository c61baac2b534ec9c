// SPDX-License-Identifier: Apache-2.0
#include "device/own_sockets.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdlib>
#include <filesystem>

namespace dseam::hal::aravis {
namespace {

/// 0 also for what is no socket.
template <typename Value>
Value option_of(int fd, int option) {
  Value value{};
  socklen_t size = sizeof value;
  (void)getsockopt(fd, SOL_SOCKET, option, &value, &size);
  return value;
}

std::uint16_t port_of(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  const bool known =
      getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0;  // NOLINT: POSIX
  return known && address.sin_family == AF_INET ? ntohs(address.sin_port) : std::uint16_t{0};
}

}  // namespace

std::vector<OwnSocket> own_udp_sockets() {
  std::vector<OwnSocket> sockets;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const int fd = std::atoi(entry.path().filename().c_str());
    const std::uint16_t port = port_of(fd);
    if (port != 0 && option_of<int>(fd, SO_TYPE) == SOCK_DGRAM) {
      sockets.push_back({fd, option_of<std::uint64_t>(fd, SO_COOKIE), port});
    }
  }
  return sockets;
}

}  // namespace dseam::hal::aravis
