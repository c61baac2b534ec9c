// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "dseam/base/buffer.hpp"
#include "dseam/link/classic.hpp"
#include "dseam/link/e2e.hpp"
#include "dseam/link/frame.hpp"
#include "dseam/link/messages.hpp"

namespace dseam::link {

/// Where the link lives on the bus. Both ends must agree.
///
/// Source:  identifiers under 0x120 may be CANopen's TIME, from 0x180 on its PDOs and SDOs.
struct Addressing {
  std::uint16_t base_id = 0x120;  ///< kAbort's identifier; the others follow.
  bool classic = false;           ///< Segments of 8 bytes instead of FD frames.

  [[nodiscard]] constexpr std::uint32_t id_of(MessageId message) const noexcept {
    return std::uint32_t{base_id} + static_cast<std::uint8_t>(message);
  }
  [[nodiscard]] constexpr bool fits_11_bits() const noexcept {
    return base_id + kMessageCount <= 0x800;
  }
};

/// The data id of each message's end-to-end protection; never sent, only in the CRC.
[[nodiscard]] constexpr std::uint16_t data_id_of(MessageId message) noexcept {
  return static_cast<std::uint16_t>(0xD5A0U + static_cast<unsigned>(message));
}
[[nodiscard]] DataIdList data_id_list_of(MessageId message) noexcept;

/// Counts, protects and, on a classic bus, segments what one end sends.
class Transmitter {
 public:
  explicit Transmitter(const Addressing& addressing) noexcept : addressing_(addressing) {}

  /// False, and nothing appended or counted, when `out` has no room for the whole message.
  [[nodiscard]] bool send(MessageId message, Frame payload, Buffer<Frame>& out) noexcept;

 private:
  bool send_segments(MessageId message, const Frame& whole, Buffer<Frame>& out) noexcept;

  Addressing addressing_;
  std::array<std::uint8_t, kMessageCount> counters_{};
  std::array<std::uint8_t, kMessageCount> segment_counters_{};
};

/// One message as it came in. Act on `payload` only where usable(status).
struct Accepted {
  MessageId message = MessageId::kAbort;
  E2eStatus status = E2eStatus::kError;
  Frame payload;
};

/// Joins, checks and judges what one end receives.
class Acceptor {
 public:
  explicit Acceptor(const Addressing& addressing) noexcept;

  /// Nothing while a segmented message is incomplete, and for an identifier that is not ours.
  [[nodiscard]] std::optional<Accepted> accept(const Frame& frame) noexcept;
  [[nodiscard]] E2eState state(MessageId message) const noexcept;
  /// Forgets the past of every message: a new session starts.
  void reset() noexcept;

 private:
  struct Stream {
    CounterCheck counter{256, 1};
    E2eWindow window;
    SegmentJoiner joiner;
  };

  Accepted judge(MessageId message, const Frame& whole) noexcept;
  std::optional<Accepted> accept_segment(MessageId message, const Frame& frame) noexcept;

  Addressing addressing_;
  std::array<Stream, kMessageCount> streams_;
};

}  // namespace dseam::link
