// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "dseam/base/result.hpp"

namespace dseam::rt {

/// Sends one prepared frame, the abort of the running session, when the process is told to end or
/// breaks: SIGTERM, SIGINT, SIGHUP, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT. After it the first
/// signal to end sets stop_requested() and goes on to the handler that was there before, and a
/// second one takes its usual course, as one of a defect does at once.
///
/// It is a help, not a safety function: what kills without a signal leaves the robot to its own
/// silence limit.
namespace last_gasp {

inline constexpr std::size_t kMaxBytes = 128;

/// Installs the handlers. Errors: kUnavailable: the system refused one.
///
/// Context: set-up, once.
[[nodiscard]] Result<> install() noexcept;
/// What is written to `fd`, three times, from now on: a raw frame of the bus, whole.
///
/// Errors:  kInvalidArgument: no descriptor, no bytes, or too many.
/// Context: any thread, not the cycle; never two at a time.
[[nodiscard]] Result<> prepare(int fd, std::span<const std::byte> frame) noexcept;
/// Nothing is welding: a signal writes nothing.
void disarm() noexcept;
/// SIGTERM, SIGINT or SIGHUP came.
[[nodiscard]] bool stop_requested() noexcept;

}  // namespace last_gasp
}  // namespace dseam::rt
