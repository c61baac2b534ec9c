// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/frame_fuser.hpp"
#include "dseam/cloud/voxel_map.hpp"
#include "dseam/pipeline/frame_store.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/pipeline/splice_chain.hpp"
#include "dseam/pipeline/stage_observer.hpp"

namespace dseam::pipeline {

/// Why a scan gives no seam before the seam is even sought, or kNone.
enum class ScanFault : std::uint8_t {
  kNone,
  kNoView,       ///< No frame was taken in.
  kUnspliced,    ///< No two views could be tied together, or the only one has no surface.
  kNotAdjusted,  ///< The adjustment of all views did not come to rest, or a direction is free.
  kMapFull,  ///< The part needs more voxels than the workspace has; nothing is made of the rest.
};
[[nodiscard]] const char* name(ScanFault fault) noexcept;

/// What became of a frame at add().
struct TakeInReport {
  bool kept = false;
  Errc error = Errc::kBadData;  ///< Why not, where it was not kept.
  SpliceChain::ViewReport view;
};

/// What fusing all frames into one map came to.
struct FuseReport {
  double cell_mm = 0.0;
  std::uint32_t points = 0;  ///< Taken into the map.
  std::uint32_t voxels = 0;
  std::uint32_t dropped_full = 0;
};

/// Everything that one scan has to say.
struct WeldReport {
  ScanFault fault = ScanFault::kNoView;
  splice::NetworkReport network;
  FuseReport coarse;
  FuseReport fine;
  seam::SeamReport seam;

  [[nodiscard]] bool weld() const noexcept { return fault == ScanFault::kNone && seam.weld(); }
};

/// From the frames of a scan to its seam: the one place in which the stages meet.
///
///     add(): frame -> markers, surface patches -> live splice        as each view comes in
///     finish(): adjust all views -> coarse map -> coarse seam -> region -> fine map -> seam
///
/// Frame:   base.
/// Memory:  `bytes()` from the arena at make(); nothing after.
/// Time:    O(pixels) for each view twice, then what the seam chain takes.
/// Context: one thread; not the cycle path.
class WeldPipeline {
 public:
  struct Config {
    SpliceChain::Config splice;
    SeamChain::Config seam;
    double coarse_cell_mm = 3.0;
    double fine_cell_mm = 1.0;
    double region_margin_mm = 40.0;  ///< Kept around the coarse seam.
    double flying_step_mm = 3.0;     ///< A pixel this far from its neighbours mixes two surfaces.
    std::optional<RegionOfInterest> region;
    std::optional<double> expected_radius_mm;
  };
  struct Capacity {
    SpliceChain::Capacity views;
    SeamChain::Capacity seam;
    std::size_t max_voxels = 600000;
    std::size_t max_seam_points = 4096;
  };

  [[nodiscard]] static std::size_t bytes(const Capacity& capacity) noexcept;
  /// The pipeline lives in the arena, beside its buffers.
  ///
  /// Errors:  kInvalidArgument: a value of a stage out of range. kOutOfMemory: the arena.
  [[nodiscard]] static Result<WeldPipeline*> make(const Config& config, const Capacity& capacity,
                                                  Arena& arena) noexcept;
  WeldPipeline(const WeldPipeline&) = delete;
  WeldPipeline& operator=(const WeldPipeline&) = delete;

  /// Forgets the scan.
  void clear() noexcept;
  /// Keeps a frame and splices it to those before.
  TakeInReport add(const depth::DepthImage& frame, const splice::ReportedPose& reported,
                   StageObserver* observer = nullptr) noexcept;
  /// Adjusts all views and finds the seam.
  WeldReport finish(StageObserver* observer = nullptr) noexcept;

  /// What finish() made; empty where it failed.
  [[nodiscard]] std::span<const seam::SeamPoint> seam_points() const noexcept {
    return seam_points_.view();
  }
  [[nodiscard]] std::span<const splice::SplicedView> views() const noexcept {
    return views_.view();
  }
  [[nodiscard]] std::span<const depth::DepthImage> frames() const noexcept {
    return store_->frames();
  }
  [[nodiscard]] std::span<const markers::Marker> markers(std::size_t view) const noexcept {
    return splice_->markers(view);
  }
  /// The fused cloud, in base: fine where a seam was found, coarse otherwise.
  [[nodiscard]] cloud::FusedCloudView merged() noexcept { return map_->view(); }

 private:
  struct Key {};  // Lets make() alone construct, where the arena says.

 public:
  WeldPipeline(Key, const Config& config, const Capacity& capacity, Arena& arena) noexcept;

 private:
  Result<> build_stages(Arena& arena) noexcept;
  FuseReport fuse(double cell_mm, const std::optional<RegionOfInterest>& region) noexcept;
  bool find_coarsely(WeldReport& report, StageObserver* observer) noexcept;
  void find_finely(WeldReport& report, StageObserver* observer) noexcept;
  [[nodiscard]] SeamInput seam_input() noexcept;

  Config config_;
  Capacity capacity_;
  std::optional<FrameStore> store_;
  std::optional<SpliceChain> splice_;
  std::optional<cloud::FrameFuser> fuser_;
  std::optional<cloud::VoxelMap> map_;
  std::optional<SeamChain> seam_;
  std::span<std::uint8_t> mask_;  ///< Of one frame: pixels that markers cover.
  Buffer<splice::SplicedView> views_;
  Buffer<seam::SeamPoint> seam_points_;
};

}  // namespace dseam::pipeline
