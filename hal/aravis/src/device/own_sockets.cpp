// SPDX-License-Identifier: Apache-2.0
#include "device/own_sockets.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

namespace dseam::hal::aravis {
namespace {

bool is_datagram_socket(int fd) {
  int type = 0;
  socklen_t size = sizeof type;
  return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM;
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
    struct stat about {};
    const std::uint16_t port = is_datagram_socket(fd) ? port_of(fd) : std::uint16_t{0};
    if (port != 0 && fstat(fd, &about) == 0) {
      sockets.push_back({fd, about.st_ino, port});
    }
  }
  return sockets;
}

}  // namespace dseam::hal::aravis
