// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "dseam/hal/socketcan/can_sys.hpp"

namespace dseam::test {

/// CAN of Linux 6.1 as hal/socketcan sees it, after what was measured on vcan: loop-back with
/// MSG_CONFIRM, ENETDOWN once after a down, ENODEV after a removal, ENOBUFS, the overflow counter.
class FakeKernel final : public hal::socketcan::CanSys {
 public:
  /// The call with this number fails, once or for ever, with `error`.
  struct Sabotage {
    int call = -1;
    int error = 0;
    bool for_ever = false;
  };

  explicit FakeKernel(bool fd = true) : fd_(fd) {}

  void sabotage(const Sabotage& what) { sabotage_ = what; }
  [[nodiscard]] int calls() const { return calls_; }
  [[nodiscard]] std::size_t open_sockets() const { return sockets_.size(); }
  [[nodiscard]] std::uint64_t sabotaged() const { return sabotaged_; }
  /// Its own, which a real kernel would not count as the caller's.
  [[nodiscard]] std::uint64_t allocations() const { return allocations_; }

  void set_up(bool up);
  void remove();
  void plug_in() { present_ = true; }
  void pass(std::int64_t ns) { now_ns_ += ns; }
  /// Frames that the driver's queue takes before ENOBUFS; nothing leaves it while it is stuck.
  void set_stuck(bool stuck) { stuck_ = stuck; }
  void set_queue_room(std::size_t frames) { room_ = frames; }
  void set_receive_room(std::size_t frames) { receive_room_ = frames; }
  /// An error frame, as the driver of the controller sends it.
  void report_error(std::uint32_t what, std::uint8_t controller_status = 0);
  /// Whatever another node could send, `size` bytes of it.
  void inject(const canfd_frame& frame, std::size_t size);

 private:
  struct Message {
    canfd_frame frame{};
    std::size_t size = 0;
    int flags = 0;
  };
  struct Socket {
    bool fd_frames = false;
    bool own = false;
    bool errors = false;
    bool frames = true;
    bool bound = false;
    int pending_error = 0;
    std::uint32_t dropped = 0;
    std::vector<can_filter> filters;
    std::deque<Message> inbox;
  };

  int fails();
  void deliver(const Message& message, int from);
  static bool wants(const Socket& socket, const Message& message);

  int open_socket(int domain, int type, int protocol) noexcept override;
  int set_option(int fd, int level, int option, const void* value,
                 socklen_t size) noexcept override;
  int bind_socket(int fd, const sockaddr* address, socklen_t size) noexcept override;
  int control(int fd, unsigned long request, void* argument) noexcept override;
  std::int64_t send_bytes(int fd, const void* bytes, std::size_t size) noexcept override;
  std::int64_t receive_message(int fd, msghdr* message) noexcept override;
  int poll_fds(pollfd* fds, nfds_t count, int timeout_ms) noexcept override;
  int close_fd(int fd) noexcept override;
  std::int64_t now_ns() noexcept override { return now_ns_; }

  bool fd_;
  bool present_ = true;
  bool up_ = true;
  bool stuck_ = false;
  std::size_t room_ = 1000;
  std::size_t receive_room_ = 1000;
  std::int64_t now_ns_ = 1'000'000'000;
  int calls_ = 0;
  std::uint64_t sabotaged_ = 0;
  std::uint64_t allocations_ = 0;
  Sabotage sabotage_;
  int next_fd_ = 3;
  std::map<int, Socket> sockets_;
  std::deque<std::pair<Message, int>> stuck_frames_;
};

}  // namespace dseam::test
