// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "dseam/base/result.hpp"
#include "dseam/hal/socketcan/can_sys.hpp"

struct can_filter;

namespace dseam::hal::socketcan {

/// What a failed system call means to whoever opened the bus.
[[nodiscard]] Errc errc_of(int error) noexcept;

/// One CAN_RAW socket, bound to an interface. Closed when it goes.
class CanSocket {
 public:
  explicit CanSocket(CanSys& sys) noexcept : sys_(&sys) {}
  CanSocket(const CanSocket&) = delete;
  CanSocket& operator=(const CanSocket&) = delete;
  ~CanSocket() { close(); }

  /// For frames. `fd`: FD frames too.
  ///
  /// Errors:  kNotFound: no such interface. kUnsupported: no CAN in this kernel, or a classic
  ///          interface and `fd`. kUnavailable: not permitted. kOutOfMemory, kIo.
  Result<> open_for_frames(std::string_view interface, bool fd,
                           std::span<const can_filter> filters) noexcept;
  /// For error frames only: they must not be lost in a flood of frames.
  Result<> open_for_errors(std::string_view interface) noexcept;
  void close() noexcept;

  /// 0: down. Negative: gone.
  [[nodiscard]] int is_up() noexcept;
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  Result<> open_unbound() noexcept;
  Result<> bind_to_interface() noexcept;
  Result<> option(int level, int option, const void* value, socklen_t size) noexcept;
  Result<> flag(int level, int option, int value) noexcept {
    return this->option(level, option, &value, sizeof(value));
  }
  [[nodiscard]] bool remember(std::string_view interface) noexcept;
  Result<> closed_after(Errc error) noexcept;

  CanSys* sys_;
  int fd_ = -1;
  std::array<char, 16> interface_{};
};

}  // namespace dseam::hal::socketcan
