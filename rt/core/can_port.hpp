// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "dseam/hal/can_bus.hpp"
#include "dseam/link/frame.hpp"

namespace dseam::rt {

/// The link's frames on a CAN bus, and back. Frames that the link cannot mean become empty ones
/// with an identifier that is none of its own.
[[nodiscard]] inline hal::CanFrame to_can(const link::Frame& frame) noexcept {
  hal::CanFrame out;
  out.id = frame.id;
  out.fd = frame.fd;
  out.size_bytes = frame.size_bytes;
  out.data = frame.data;
  return out;
}

[[nodiscard]] inline link::Frame from_can(const hal::CanFrame& frame) noexcept {
  link::Frame out;
  out.id = frame.extended ? ~0U : frame.id;
  out.fd = frame.fd;
  out.size_bytes = std::min(frame.size_bytes, hal::CanFrame::kMaxSizeBytes);
  out.data = frame.data;
  return out;
}

}  // namespace dseam::rt
