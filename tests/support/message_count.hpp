// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>

namespace dseam::test {

/// How many messages a queue is tried with: DSEAM_MESSAGES, or `quick`.
inline std::uint64_t message_count(std::uint64_t quick) {
  const char* asked = std::getenv("DSEAM_MESSAGES");
  return asked != nullptr ? std::strtoull(asked, nullptr, 10) : quick;
}

}  // namespace dseam::test
