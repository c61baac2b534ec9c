// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <variant>

#include "dseam/base/expects.hpp"

namespace dseam {

/// Every way in which something that is asked once (make, open, load, send) can fail.
///
/// Programming errors go to DSEAM_EXPECTS instead, latched run-time faults have `rt::Fault`,
/// and a stage that streams cannot fail at all: it returns a report of counts.
enum class Errc : std::uint8_t {
  kInvalidArgument,  ///< A value is outside its documented range.
  kOutOfMemory,      ///< The lent storage or the arena is too small.
  kTimeout,          ///< The deadline passed first; retrying is safe.
  kQueueFull,        ///< The device queue is full; retrying later is safe.
  kDisconnected,     ///< The device is gone or bus-off; reopen it.
  kIo,               ///< The driver reported something else.
  kNotFound,         ///< No such device, file or feature.
  kUnavailable,      ///< Busy, or not permitted to this user.
  kUnsupported,      ///< The device or format cannot do what was asked.
  kBadData,          ///< What was read is damaged, or contradicts itself.
};

/// The name of the code without its `k`, for logs and tests.
[[nodiscard]] constexpr const char* name(Errc code) noexcept {
  constexpr const char* kNames[] = {"InvalidArgument", "OutOfMemory", "Timeout",  "QueueFull",
                                    "Disconnected",    "Io",          "NotFound", "Unavailable",
                                    "Unsupported",     "BadData"};
  return kNames[static_cast<std::uint8_t>(code)];
}

/// A `T`, or the reason why there is none. C++20 has no std::expected; this is the part we use.
template <typename T = std::monostate>
class [[nodiscard]] Result {
 public:
  constexpr Result() : state_(T{}) {}
  constexpr Result(T value) : state_(std::move(value)) {}  // NOLINT(google-explicit-constructor)
  constexpr Result(Errc error) : state_(error) {}          // NOLINT(google-explicit-constructor)

  [[nodiscard]] constexpr bool ok() const noexcept { return state_.index() == 0; }
  [[nodiscard]] constexpr Errc error() const noexcept {
    DSEAM_EXPECTS(!ok());
    return *std::get_if<1>(&state_);
  }
  [[nodiscard]] constexpr T& value() noexcept {
    DSEAM_EXPECTS(ok());
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] constexpr const T& value() const noexcept {
    DSEAM_EXPECTS(ok());
    return *std::get_if<0>(&state_);
  }

 private:
  std::variant<T, Errc> state_;
};

}  // namespace dseam
