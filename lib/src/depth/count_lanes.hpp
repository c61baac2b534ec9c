// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/lanes.hpp"
#include "dseam/depth/depth_image.hpp"

namespace dseam::depth {

/// The counts of eight pixels of a row, `stride` apart from `u` on; 0 outside the image.
[[nodiscard]] inline lanes::IntLanes counts_at(const DepthImage& image, std::int64_t u,
                                               std::int64_t v, std::int64_t stride) noexcept {
  const std::int64_t width = image.intrinsics.width;
  if (v < 0 || v >= static_cast<std::int64_t>(image.intrinsics.height)) {
    return lanes::splat(0);
  }
  const std::uint16_t* row = image.depth.data() + v * width;
  constexpr auto kEight = static_cast<std::int64_t>(lanes::kLanes);
  if (stride == 1 && u >= 0 && u + kEight <= width) {
    return lanes::widen(row + u);
  }
  std::int32_t counts[lanes::kLanes] = {};
  for (std::int64_t i = 0; i < kEight; ++i) {
    const std::int64_t at = u + i * stride;
    counts[i] = at >= 0 && at < width ? row[at] : 0;
  }
  return lanes::load(counts);
}

[[nodiscard]] inline bool has_sensible_shape(const DepthImage& image) noexcept {
  const Intrinsics& k = image.intrinsics;
  return image.depth.size() == std::size_t{k.width} * k.height && k.fx > 0.0 && k.fy > 0.0;
}

}  // namespace dseam::depth
