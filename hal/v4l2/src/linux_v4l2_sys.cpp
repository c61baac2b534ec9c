// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

#include "dseam/hal/v4l2/v4l2_sys.hpp"

namespace dseam::hal::v4l2 {
namespace {

int or_errno(int result) noexcept { return result < 0 ? -errno : result; }

class LinuxV4l2Sys final : public V4l2Sys {
  int open(const char* path) noexcept override {
    return or_errno(::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC));
  }
  int close(int fd) noexcept override { return or_errno(::close(fd)); }
  int ioctl(int fd, unsigned long request, void* argument) noexcept override {
    return or_errno(::ioctl(fd, request, argument));
  }
  int map(int fd, std::size_t size_bytes, std::uint32_t offset, Mapping& out) noexcept override {
    void* start = mmap(nullptr, size_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    if (start == MAP_FAILED) {
      return -errno;
    }
    out = {static_cast<std::byte*>(start), size_bytes};
    return 0;
  }
  int unmap(const Mapping& mapping) noexcept override {
    return or_errno(munmap(mapping.start, mapping.size_bytes));
  }
  int poll(int fd, int timeout_ms) noexcept override {
    pollfd asked{.fd = fd, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&asked, 1, timeout_ms);
    return ready < 0 ? -errno : asked.revents;
  }
};

}  // namespace

V4l2Sys& linux_v4l2_sys() noexcept {
  static LinuxV4l2Sys sys;
  return sys;
}

}  // namespace dseam::hal::v4l2
