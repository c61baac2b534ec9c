// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "dseam/torch/torch_path.hpp"

namespace dseam::trajectory {

inline constexpr double kSamePlaceMm = 1e-9;

/// The point at which the stretch that begins at `begin` ends: the next stop, or the next point at
/// the same place, or the last one.
[[nodiscard]] inline std::size_t stretch_end(torch::PathView path, std::size_t begin) noexcept {
  if (path[begin + 1].s_mm - path[begin].s_mm <= kSamePlaceMm) {
    return begin + 1;
  }
  std::size_t end = begin + 1;
  while (end + 1 < path.size() && !path[end].stop &&
         path[end + 1].s_mm - path[end].s_mm > kSamePlaceMm) {
    ++end;
  }
  return end;
}

}  // namespace dseam::trajectory
