// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/link/frame.hpp"

namespace dseam::hal {

[[nodiscard]] constexpr CanFrame to_can(const link::Frame& frame) noexcept {
  return {frame.id, false, frame.fd, frame.size_bytes, frame.data, 0};
}
[[nodiscard]] constexpr link::Frame to_link(const CanFrame& frame) noexcept {
  return {frame.id, frame.fd, frame.size_bytes, frame.data};
}

/// Carries frames between a CanBus and one end of the weld link, `link::Sender` or
/// `link::Receiver`. One turn a cycle: all that came in, then all that is due to go out.
///
/// Memory:  its own outbox; no heap.
/// Time:    at most kMostReceived frames a turn, however much the bus babbles.
/// Context: one thread; real-time safe as the bus is.
class LinkPort {
 public:
  static constexpr std::size_t kMostReceived = 256;
  static constexpr std::size_t kMostSent = 128;  ///< Room for a turn's points as segments.
  static constexpr std::int64_t kBlockedNs = 20'000'000;

  /// Counters since construction.
  struct Report {
    std::uint64_t received = 0;
    std::uint64_t foreign = 0;  ///< 29-bit identifiers: never ours.
    std::uint64_t sent = 0;
    std::uint64_t refused = 0;  ///< The bus had no room; the link's own repetition replaces them.
    std::uint64_t late = 0;     ///< Turns that left frames for the next one.
    std::uint64_t lost = 0;     ///< Turns in which the bus was gone.
  };

  explicit LinkPort(CanBus& bus) noexcept : bus_(&bus) {}
  LinkPort(const LinkPort&) = delete;
  LinkPort& operator=(const LinkPort&) = delete;

  template <typename End>
  void turn(End& end, std::int64_t now_ns) noexcept {
    if (!receive_all(end, now_ns)) {
      ++report_.lost;
      end.bus_lost(now_ns);
    }
    out_.clear();
    end.poll(now_ns, out_);
    if (!send_all(now_ns)) {
      end.bus_lost(now_ns);
    }
  }
  [[nodiscard]] const Report& report() const noexcept { return report_; }

 private:
  template <typename End>
  bool receive_all(End& end, std::int64_t now_ns) noexcept {
    for (std::size_t i = 0; i < kMostReceived; ++i) {
      const Result<CanFrame> frame = bus_->receive(std::chrono::nanoseconds(0));
      if (!frame.ok()) {
        return frame.error() == Errc::kTimeout;
      }
      ++report_.received;
      if (frame.value().extended) {
        ++report_.foreign;
      } else {
        end.on_frame(to_link(frame.value()), now_ns);
      }
    }
    ++report_.late;
    return true;
  }

  /// False when the bus is gone, or has taken nothing for as long as the peer stays patient.
  bool send_all(std::int64_t now_ns) noexcept {
    for (const link::Frame& frame : out_.view()) {
      const Result<> sent = bus_->send(to_can(frame));
      if (sent.ok()) {
        ++report_.sent;
        refused_since_ns_ = kNever;
        continue;
      }
      ++report_.refused;
      if (sent.error() != Errc::kQueueFull) {
        return false;
      }
      if (refused_since_ns_ == kNever) {
        refused_since_ns_ = now_ns;
      }
    }
    return refused_since_ns_ == kNever || now_ns - refused_since_ns_ <= kBlockedNs;
  }

  static constexpr std::int64_t kNever = INT64_MIN;

  CanBus* bus_;
  Report report_;
  std::int64_t refused_since_ns_ = kNever;
  std::array<link::Frame, kMostSent> storage_;
  Buffer<link::Frame> out_{storage_};
};

}  // namespace dseam::hal
