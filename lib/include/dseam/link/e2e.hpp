// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dseam::link {

/// What one received frame is worth.
enum class E2eStatus : std::uint8_t {
  kOk,             ///< Whole, and the next one.
  kOkSomeLost,     ///< Whole; up to max_delta - 1 before it are missing.
  kRepeated,       ///< Whole, but seen already.
  kWrongSequence,  ///< Whole, but old, or too many before it are missing.
  kError,          ///< Damaged, masqueraded, or of the wrong length.
};

/// Only these two may be acted upon.
[[nodiscard]] constexpr bool usable(E2eStatus status) noexcept {
  return status == E2eStatus::kOk || status == E2eStatus::kOkSomeLost;
}

/// Profile 5: CRC-16 little endian, 8-bit counter, then data; the data id is in the CRC alone.
/// `offset_bytes` is where the three header bytes stand.
///
/// Errors:  a frame shorter than the header is left alone, and is never valid.
/// Source:  AUTOSAR FO R22-11, E2E Protocol Specification, profile 5.
void protect_p05(std::span<std::byte> frame, std::uint16_t data_id, std::uint8_t counter,
                 std::size_t offset_bytes = 0) noexcept;
[[nodiscard]] bool intact_p05(std::span<const std::byte> frame, std::uint16_t data_id,
                              std::size_t offset_bytes = 0) noexcept;
[[nodiscard]] std::uint8_t counter_p05(std::span<const std::byte> frame) noexcept;

/// One byte for each value of profile 22's counter.
using DataIdList = std::array<std::uint8_t, 16>;

/// Profile 22, for classic frames: CRC-8 (0x2F), then a 4-bit counter in the low half of byte 1.
/// Chosen over profile 1 and 11, whose CRC misses 3-bit errors at 64 bits.
///
/// Errors:  as profile 5.
/// Source:  AUTOSAR FO R22-11, E2E Protocol Specification, profile 22.
void protect_p22(std::span<std::byte> frame, const DataIdList& data_ids,
                 std::uint8_t counter) noexcept;
[[nodiscard]] bool intact_p22(std::span<const std::byte> frame,
                              const DataIdList& data_ids) noexcept;
[[nodiscard]] std::uint8_t counter_p22(std::span<const std::byte> frame) noexcept;

/// Judges the counters of one message. The first whole frame is taken as it is.
class CounterCheck {
 public:
  /// `modulus`: 256 for profile 5, 16 for profile 22.
  CounterCheck(unsigned modulus, unsigned max_delta) noexcept
      : modulus_(modulus), max_delta_(max_delta) {}

  E2eStatus check(bool intact, std::uint8_t counter) noexcept;

 private:
  unsigned modulus_;
  unsigned max_delta_;
  unsigned last_ = 0;
  bool seen_ = false;
};

/// Whether the stream of one message can be trusted as a whole.
enum class E2eState : std::uint8_t { kInit, kValid, kInvalid };

/// Looks back over the last kWindow frames.
///
/// Source:  AUTOSAR FO R22-11, E2E Protocol Specification, the E2E state machine.
class E2eWindow {
 public:
  static constexpr std::size_t kWindow = 10;
  static constexpr unsigned kMinOk = 3;
  static constexpr unsigned kMaxErrors = 2;

  E2eState add(E2eStatus status) noexcept;
  [[nodiscard]] E2eState state() const noexcept { return state_; }

 private:
  std::array<E2eStatus, kWindow> recent_{};
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
  E2eState state_ = E2eState::kInit;
};

}  // namespace dseam::link
