// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

/// Calls back for pixels `reach` long half axes around a rim, those of the image: of a large disc
/// each n-th of each n-th row.
template <typename Call>
void for_each_around(const depth::DepthImage& frame, const geometry::Ellipse& rim, double reach,
                     const Call& call) noexcept {
  const auto limit = [](double x, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  const double r = reach * rim.a;
  const auto step = static_cast<std::uint32_t>(std::clamp(r / 20.0, 1.0, 1e4));
  const std::uint32_t u_end = limit(rim.u + r + 1.0, frame.intrinsics.width);
  const std::uint32_t v_end = limit(rim.v + r + 1.0, frame.intrinsics.height);
  for (std::uint32_t v = limit(rim.v - r, v_end); v < v_end; v += step) {
    for (std::uint32_t u = limit(rim.u - r, u_end); u < u_end; u += step) {
      call(u, v);
    }
  }
}

}  // namespace dseam::markers
