// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>
#include <vector>

#include "dseam/hal/bus/send_queue.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/hal/socketcan/can_socket.hpp"
#include "dseam/hal/socketcan/error_frame.hpp"

namespace dseam::hal::socketcan {

/// A CAN interface of Linux.
///
/// Few frames are given to the kernel at a time; the others wait in a queue of our own, most urgent
/// first, until their deadline. A frame counts as confirmed when the kernel shows it to us as sent.
/// No confirmation for `confirm_limit_ns` means a dead bus, whatever poll() says. An interface that
/// went down or away is tried again every `retry_ns`; what was queued before is never sent after.
///
/// Memory:  the queue, at open().
/// Time:    send() and receive(0): a bounded number of system calls that do not block.
/// Context: as CanBus; one mutex, held for a handful of system calls, guards the sending side.
class SocketCanBus final : public CanBus {
 public:
  /// `id & mask` must equal `match & mask`.
  struct Filter {
    std::uint32_t match = 0;
    std::uint32_t mask = 0;
  };
  /// Drops what the kernel has queued, for example by setting the interface down and up.
  using PurgeHook = bool (*)(void* context) noexcept;

  struct Config {
    bool fd = true;
    bool bit_rate_switch = true;
    std::array<Filter, 4> filters{};  ///< Must let our own frames pass too.
    std::size_t filter_count = 0;     ///< 0: everything.
    std::size_t send_queue = 64;
    std::int64_t send_deadline_ns = 50'000'000;
    std::uint32_t most_in_kernel = 6;
    std::int64_t confirm_limit_ns = 100'000'000;
    std::int64_t retry_ns = 100'000'000;
    PurgeHook purge_hook = nullptr;
    void* purge_context = nullptr;
  };

  /// Errors:  as CanSocket::open_for_frames(). link_check.hpp says what to do about them.
  [[nodiscard]] static Result<std::unique_ptr<SocketCanBus>> open(std::string_view interface,
                                                                  const Config& config,
                                                                  CanSys& sys = linux_can_sys());
  [[nodiscard]] ErrorCounts error_counts() const noexcept;
  /// Times the interface came back.
  [[nodiscard]] std::uint64_t reconnects() const noexcept;

 private:
  enum class Presence : std::uint8_t { kUp, kDown, kGone };

  SocketCanBus(std::string_view interface, const Config& config, CanSys& sys);

  Result<> do_send(const CanFrame& frame) noexcept override;
  Result<CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept override;
  Result<> do_purge() noexcept override;
  [[nodiscard]] BusHealth do_health() const noexcept override;

  Result<> open_sockets() noexcept;
  [[nodiscard]] bool usable(std::int64_t now_ns) noexcept;
  void recover(std::int64_t now_ns) noexcept;
  void come_back() noexcept;
  void lose(Presence presence, std::int64_t now_ns) noexcept;
  void pump(std::int64_t now_ns) noexcept;
  void judge_confirmations(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool write_frame(const CanFrame& frame, std::int64_t now_ns) noexcept;
  [[nodiscard]] Result<CanFrame> read_frame(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool take_in(const struct msghdr& message, std::int64_t size,
                             const struct canfd_frame& raw, CanFrame& frame) noexcept;
  void read_errors() noexcept;
  void wait(std::int64_t timeout_ns) noexcept;
  void failed(int error, std::int64_t now_ns) noexcept;

  Config config_;
  CanSys& sys_;
  std::array<char, 16> interface_{};
  CanSocket frames_;
  CanSocket errors_;
  std::vector<SendQueue::Slot> slots_;

  mutable std::mutex mutex_;
  SendQueue queue_;
  BusHealth health_;
  ErrorCounts error_counts_;
  Presence presence_ = Presence::kUp;
  std::uint64_t in_kernel_ = 0;
  std::uint64_t overflow_seen_ = 0;
  std::int64_t last_confirm_ns_ = 0;
  std::int64_t next_retry_ns_ = 0;
  std::uint64_t reconnects_ = 0;
};

}  // namespace dseam::hal::socketcan
