// SPDX-License-Identifier: Apache-2.0
#include "dseam/depth/unproject.hpp"

#include "count_lanes.hpp"

namespace dseam::depth {

UnprojectReport unproject(const DepthImage& image, cloud::CloudBuffer& cloud_camera,
                          Buffer<std::uint32_t>& pixels) noexcept {
  cloud_camera.clear();
  pixels.clear();
  UnprojectReport report;
  if (!has_sensible_shape(image)) {
    return report;
  }
  const Intrinsics& k = image.intrinsics;
  const auto mm_per_count = static_cast<float>(image.mm_per_count);
  for (std::uint32_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const std::uint16_t count = image.depth[pixel];
    if (count == 0) {
      ++report.without_depth;
      continue;
    }
    const float z_mm = static_cast<float>(count) * mm_per_count;
    const auto ray_x = static_cast<float>((pixel % k.width - k.cx) / k.fx);
    const auto ray_y = static_cast<float>((pixel / k.width - k.cy) / k.fy);
    if (pixels.full() || !cloud_camera.append({ray_x * z_mm, ray_y * z_mm, z_mm})) {
      ++report.dropped_full;
    } else {
      (void)pixels.append(pixel);
      ++report.points;
    }
  }
  return report;
}

}  // namespace dseam::depth
