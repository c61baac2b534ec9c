// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "dseam/base/result.hpp"

namespace dseam::hal {

/// One CAN frame, classic (up to 8 bytes) or FD (up to 64).
struct CanFrame {
  static constexpr std::uint8_t kMaxSizeBytes = 64;

  std::uint32_t id = 0;  ///< 11 bits, or 29 when `extended`.
  bool extended = false;
  bool fd = false;
  std::uint8_t size_bytes = 0;
  std::array<std::byte, kMaxSizeBytes> data{};
  std::int64_t stamp_ns = 0;  ///< Received frames: monotonic time of arrival.
};

/// Whether CAN has such a frame: FD knows seven lengths above 8, identifiers have 11 or 29 bits.
[[nodiscard]] constexpr bool is_can_frame(const CanFrame& frame) noexcept {
  constexpr std::array<std::uint8_t, 7> kLongSizes = {12, 16, 20, 24, 32, 48, 64};
  bool size = frame.size_bytes <= 8;
  for (const std::uint8_t bytes : kLongSizes) {
    size = size || (frame.fd && frame.size_bytes == bytes);
  }
  return size && frame.id < (frame.extended ? 0x2000'0000U : 0x800U);
}

/// The controller's state as CAN defines it, and whether the interface is there at all.
enum class BusState : std::uint8_t { kErrorActive, kErrorWarning, kErrorPassive, kBusOff, kDown };

/// Counters since open; they only rise.
struct BusHealth {
  BusState state = BusState::kErrorActive;
  std::uint64_t sent = 0;
  std::uint64_t confirmed = 0;  ///< Own frames seen on the bus: sent and acknowledged.
  std::uint64_t received = 0;
  std::uint64_t send_dropped = 0;
  std::uint64_t receive_overflow = 0;  ///< Frames the kernel or the controller had no room for.
  std::uint64_t error_frames = 0;
  std::uint64_t malformed = 0;  ///< Frames that were not what CAN allows.
};

/// One opened CAN interface. Backends: hal/socketcan (Linux), hal/sim, hal/fake.
///
/// Context: one sending and one receiving thread at the same time. Real-time safe once opened.
class CanBus {
 public:
  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;

  /// Queues one frame; never waits.
  ///
  /// Errors:  kQueueFull: try again later. kDisconnected: bus-off, down or gone; reopen.
  ///          kInvalidArgument: a frame that CAN does not have. kUnsupported: FD on a classic bus.
  Result<> send(const CanFrame& frame) noexcept {
    return is_can_frame(frame) ? do_send(frame) : Errc::kInvalidArgument;
  }
  /// Takes the oldest received frame, waiting at most `timeout`; zero polls.
  ///
  /// Errors:  kTimeout: none came. kDisconnected: as send().
  Result<CanFrame> receive(std::chrono::nanoseconds timeout) noexcept {
    return do_receive(timeout);
  }
  /// Drops every frame that is queued but not yet on the wire: nothing old may move a robot.
  Result<> purge() noexcept { return do_purge(); }
  [[nodiscard]] BusHealth health() const noexcept { return do_health(); }

 protected:
  ~CanBus() = default;  // Owners hold the concrete type: no delete, so no heap, through a base.

 private:
  virtual Result<> do_send(const CanFrame& frame) noexcept = 0;
  virtual Result<CanFrame> do_receive(std::chrono::nanoseconds timeout) noexcept = 0;
  virtual Result<> do_purge() noexcept = 0;
  [[nodiscard]] virtual BusHealth do_health() const noexcept = 0;
};

}  // namespace dseam::hal
