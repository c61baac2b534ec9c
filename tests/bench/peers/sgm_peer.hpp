// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace dseam::bench {

/// OpenCV's semi-global matching of two rectified gray images, behind plain types.
struct SgmRange {
  int min_disparity_px = 0;
  int num_disparities = 128;  ///< A multiple of 16.
};

/// Disparity of each pixel of the left image, row by row; negative where there is none.
[[nodiscard]] std::vector<float> match_semi_globally(std::span<const std::uint8_t> left,
                                                     std::span<const std::uint8_t> right,
                                                     std::uint32_t width, const SgmRange& range);

}  // namespace dseam::bench
