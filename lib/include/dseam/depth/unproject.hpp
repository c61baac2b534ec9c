// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/depth/depth_image.hpp"

namespace dseam::depth {

struct UnprojectReport {
  std::uint32_t points = 0;
  std::uint32_t without_depth = 0;
  std::uint32_t dropped_full = 0;  ///< Pixels for which `cloud_camera` or `pixels` had no room.
};

/// The points of a depth image, row by row, and the pixel each comes from (v * width + u).
///
/// Frame:   camera.
/// Errors:  an image whose spans do not fit its size has no points.
/// Time:    O(pixels).
UnprojectReport unproject(const DepthImage& image, cloud::CloudBuffer& cloud_camera,
                          Buffer<std::uint32_t>& pixels) noexcept;

}  // namespace dseam::depth
