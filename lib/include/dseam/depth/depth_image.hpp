// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/geometry/vec3f.hpp"

namespace dseam::depth {

/// A pinhole camera without distortion: u = fx x / z + cx, v = fy y / z + cy.
///
/// Units:   pixels; the centre of the upper left pixel is (0, 0).
struct Intrinsics {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double fx = 0.0;
  double fy = 0.0;
  double cx = 0.0;
  double cy = 0.0;
};

/// One undistorted frame by reference: what the pipeline keeps of a view instead of its points.
///
/// Frame:   camera, +z along the optical axis, x right, y down.
/// Shape:   `depth` has width * height counts row by row, 0 = no measurement, z (not range);
///          `gray` is registered to it pixel by pixel, or empty.
struct DepthImage {
  Intrinsics intrinsics;
  double mm_per_count = 0.0;
  std::span<const std::uint16_t> depth;
  std::span<const std::uint8_t> gray;

  [[nodiscard]] std::uint16_t count_at(std::uint32_t u, std::uint32_t v) const noexcept {
    return depth[static_cast<std::size_t>(v) * intrinsics.width + u];
  }
  [[nodiscard]] std::uint8_t gray_at(std::uint32_t u, std::uint32_t v) const noexcept {
    return gray[static_cast<std::size_t>(v) * intrinsics.width + u];
  }
};

/// The point on the ray of pixel (u, v) with depth `z_mm`; u and v may be between pixels.
[[nodiscard]] inline geometry::Vec3f back_project(const Intrinsics& k, float u, float v,
                                                  float z_mm) noexcept {
  return {(u - static_cast<float>(k.cx)) * z_mm / static_cast<float>(k.fx),
          (v - static_cast<float>(k.cy)) * z_mm / static_cast<float>(k.fy), z_mm};
}

}  // namespace dseam::depth
