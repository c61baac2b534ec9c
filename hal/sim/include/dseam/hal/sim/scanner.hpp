// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/hal/sim/scene.hpp"
#include "dseam/hal/sim/truth.hpp"

namespace dseam::hal::sim {

/// One frame of the simulated scanner, row by row.
struct Rendering {
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> gray;
  std::vector<Surface> surface;  ///< What each pixel's centre sees, measured or not.
  std::vector<float> true_z_mm;  ///< Before every error; 0 where nothing is.
};

/// What takes measurements away near the joint: a dead band and a stretch that no view sees.
struct Blind {
  TruthCurve joint_part;
  double dead_band_mm = 0.0;
  double unseen_from_mm = 0.0;  ///< Along the joint.
  double unseen_length_mm = 0.0;
  double unseen_reach_mm = 0.0;
};

/// Ray-casts one frame: the same scene, pose and seed give the same bits.
///
/// Time:    well under a second for 1296 x 966 on one core.
/// Memory:  `out` keeps its capacity from one call to the next.
void render(const Scene& scene, const Blind& blind, const CellConfig& config,
            const geometry::RigidTransform& T_part_camera, std::uint64_t seed, Rendering& out);

/// `rendering` as the stages take it.
[[nodiscard]] depth::DepthImage image_of(const Rendering& rendering, const ScannerConfig& config);

}  // namespace dseam::hal::sim
