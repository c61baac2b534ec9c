// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/e2e.hpp"

#include <algorithm>

#include "dseam/link/crc.hpp"

namespace dseam::link {
namespace {

constexpr std::size_t kHeaderP05 = 3;
constexpr std::size_t kHeaderP22 = 2;

std::uint16_t crc_p05(std::span<const std::byte> frame, std::uint16_t data_id,
                      std::size_t offset_bytes) noexcept {
  const std::array<std::byte, 2> id = {static_cast<std::byte>(data_id & 0xFFU),
                                       static_cast<std::byte>(data_id >> 8U)};
  const std::uint16_t before = crc16_ccitt(frame.first(offset_bytes));
  return crc16_ccitt(id, crc16_ccitt(frame.subspan(offset_bytes + 2), before));
}

std::uint8_t crc_p22(std::span<const std::byte> frame, const DataIdList& data_ids) noexcept {
  const std::array<std::byte, 1> id = {std::byte{data_ids[counter_p22(frame)]}};
  return crc8_h2f(id, crc8_h2f(frame.subspan(1)));
}

}  // namespace

void protect_p05(std::span<std::byte> frame, std::uint16_t data_id, std::uint8_t counter,
                 std::size_t offset_bytes) noexcept {
  if (frame.size() < offset_bytes + kHeaderP05) {
    return;
  }
  frame[offset_bytes + 2] = std::byte{counter};
  const std::uint16_t crc = crc_p05(frame, data_id, offset_bytes);
  frame[offset_bytes] = static_cast<std::byte>(crc & 0xFFU);
  frame[offset_bytes + 1] = static_cast<std::byte>(crc >> 8U);
}

bool intact_p05(std::span<const std::byte> frame, std::uint16_t data_id,
                std::size_t offset_bytes) noexcept {
  if (frame.size() < offset_bytes + kHeaderP05) {
    return false;
  }
  const unsigned low = std::to_integer<unsigned>(frame[offset_bytes]);
  const unsigned high = std::to_integer<unsigned>(frame[offset_bytes + 1]);
  return (low | (high << 8U)) == crc_p05(frame, data_id, offset_bytes);
}

std::uint8_t counter_p05(std::span<const std::byte> frame) noexcept {
  return frame.size() < kHeaderP05 ? std::uint8_t{0} : std::to_integer<std::uint8_t>(frame[2]);
}

void protect_p22(std::span<std::byte> frame, const DataIdList& data_ids,
                 std::uint8_t counter) noexcept {
  if (frame.size() < kHeaderP22) {
    return;
  }
  frame[1] = (frame[1] & std::byte{0xF0}) | static_cast<std::byte>(counter & 0x0FU);
  frame[0] = std::byte{crc_p22(frame, data_ids)};
}

bool intact_p22(std::span<const std::byte> frame, const DataIdList& data_ids) noexcept {
  return frame.size() >= kHeaderP22 &&
         std::to_integer<std::uint8_t>(frame[0]) == crc_p22(frame, data_ids);
}

std::uint8_t counter_p22(std::span<const std::byte> frame) noexcept {
  return frame.size() < kHeaderP22 ? std::uint8_t{0}
                                   : std::to_integer<std::uint8_t>(frame[1] & std::byte{0x0F});
}

E2eStatus CounterCheck::check(bool intact, std::uint8_t counter) noexcept {
  if (!intact) {
    return E2eStatus::kError;
  }
  const unsigned delta = seen_ ? (counter + modulus_ - last_) % modulus_ : 1U;
  last_ = counter;
  seen_ = true;
  if (delta == 0) {
    return E2eStatus::kRepeated;
  }
  if (delta > max_delta_) {
    return E2eStatus::kWrongSequence;
  }
  return delta == 1 ? E2eStatus::kOk : E2eStatus::kOkSomeLost;
}

E2eState E2eWindow::add(E2eStatus status) noexcept {
  recent_[next_] = status;
  next_ = (next_ + 1) % kWindow;
  filled_ = std::min(filled_ + 1, kWindow);
  const auto seen = std::span(recent_).first(filled_);
  const auto ok = static_cast<std::size_t>(std::ranges::count_if(seen, usable));
  const auto errors = static_cast<std::size_t>(std::ranges::count(seen, E2eStatus::kError));

  if (errors > kMaxErrors || (filled_ == kWindow && ok < kMinOk)) {
    state_ = E2eState::kInvalid;
  } else if (ok >= kMinOk) {
    state_ = E2eState::kValid;
  }
  return state_;
}

}  // namespace dseam::link
