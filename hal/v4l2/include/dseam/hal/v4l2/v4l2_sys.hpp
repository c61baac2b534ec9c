// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace dseam::hal::v4l2 {

/// The system calls that this backend makes, so that a test can let the n-th of them fail.
///
/// Errors:  every call returns a negative errno when it fails.
class V4l2Sys {
 public:
  V4l2Sys() = default;
  V4l2Sys(const V4l2Sys&) = delete;
  V4l2Sys& operator=(const V4l2Sys&) = delete;

  struct Mapping {
    std::byte* start = nullptr;
    std::size_t size_bytes = 0;
  };

  /// A descriptor, opened for reading and writing, not blocking, closed on exec.
  virtual int open(const char* path) noexcept = 0;
  virtual int close(int fd) noexcept = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) noexcept = 0;
  virtual int map(int fd, std::size_t size_bytes, std::uint32_t offset, Mapping& out) noexcept = 0;
  virtual int unmap(const Mapping& mapping) noexcept = 0;
  /// The events that came (0: none in time).
  virtual int poll(int fd, int timeout_ms) noexcept = 0;

 protected:
  ~V4l2Sys() = default;
};

/// The kernel's.
V4l2Sys& linux_v4l2_sys() noexcept;

}  // namespace dseam::hal::v4l2
