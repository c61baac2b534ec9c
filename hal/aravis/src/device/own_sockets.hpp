// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace dseam::hal::aravis {

/// A UDP socket of this process with a port, whoever made it.
struct OwnSocket {
  int fd = -1;
  std::uint64_t cookie = 0;  ///< Of one socket only, while descriptors are used again.
  std::uint16_t port = 0;
};

/// Aravis does not tell its descriptors: they are looked for among all.
[[nodiscard]] std::vector<OwnSocket> own_udp_sockets();

}  // namespace dseam::hal::aravis
