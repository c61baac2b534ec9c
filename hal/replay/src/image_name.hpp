// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dseam::hal::replay {

/// Six digits and the ending, as BOP names images: 000007.png.
[[nodiscard]] inline std::string image_name(std::uint32_t id) {
  const std::string digits = std::to_string(id);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + ".png";
}

}  // namespace dseam::hal::replay
