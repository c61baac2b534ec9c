// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dseam/cloud/voxel_map.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {

/// The simulated cell's frames with their true poses.
class TrueScan {
 public:
  explicit TrueScan(const hal::sim::Cell& cell);

  [[nodiscard]] std::span<const depth::DepthImage> frames() const { return frames_; }
  [[nodiscard]] std::span<const splice::SplicedView> views() const { return views_; }

 private:
  std::vector<hal::sim::Rendering> renderings_;
  std::vector<depth::DepthImage> frames_;
  std::vector<splice::SplicedView> views_;
};

/// The frames fused into cells of `cell_mm`, and all that the seam is sought in.
///
/// Pixels that fly by `max_step_mm` are left out; 0 keeps all.
///
/// Frame:   base; a box of `reach_mm` each way round the part's origin is kept.
class FusedScan {
 public:
  FusedScan(const hal::sim::Cell& cell, const TrueScan& scan, float cell_mm = 1.0F,
            float reach_mm = 130.0F, float max_step_mm = 0.0F);

  [[nodiscard]] pipeline::SeamInput input();

 private:
  const TrueScan& scan_;
  ArenaOwner owner_;
  cloud::VoxelMap map_;
};

}  // namespace dseam::test
