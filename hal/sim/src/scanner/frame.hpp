// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dseam/hal/sim/scanner.hpp"

namespace dseam::hal::sim {

/// One view of the scene: where rays come from and where they go.
///
/// Frame:   part.
struct Viewpoint {
  const Scene& scene;
  const CellConfig& config;
  depth::Intrinsics intrinsics;
  geometry::RigidTransform T_part_camera;

  [[nodiscard]] Ray ray(double u, double v) const noexcept {
    const Eigen::Vector3d direction((u - intrinsics.cx) / intrinsics.fx,
                                    (v - intrinsics.cy) / intrinsics.fy, 1.0);
    return {T_part_camera.translation_mm, T_part_camera.rotation * direction};
  }
};

enum class Paint : std::uint8_t { kBare, kDisc, kRing };

/// What the ray through one pixel's centre found, before any error.
struct Sample {
  float z_mm = 0.0F;
  float facing = 0.0F;  ///< Cosine between ray and normal.
  float luminance = 0.0F;
  std::uint16_t body = 0;
  Surface surface = Surface::kNothing;
  Paint paint = Paint::kBare;
};

/// Casts the ray through (u, v) at the candidate bodies.
[[nodiscard]] Sample sample(const Viewpoint& view, double u, double v,
                            std::span<const std::uint16_t> candidates) noexcept;

/// A frame cut into square tiles, each with the bodies that its rays can meet.
class Tiling {
 public:
  static constexpr std::uint32_t kSide = 16;

  explicit Tiling(const Viewpoint& view);
  [[nodiscard]] std::span<const std::uint16_t> candidates(std::uint32_t u,
                                                          std::uint32_t v) const noexcept;

 private:
  std::uint32_t across_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint16_t> bodies_;
};

/// One sample for each pixel; then the luminance of pixels at edges averaged over their area.
void cast_frame(const Viewpoint& view, const Tiling& tiling, std::vector<Sample>& samples);
void smooth_edges(const Viewpoint& view, const Tiling& tiling, std::vector<Sample>& samples);

}  // namespace dseam::hal::sim
