// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/weld_pipeline.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "pipeline/marker_mask.hpp"
#include "pipeline/seam/region.hpp"

namespace dseam::pipeline {
namespace {

void tell(StageObserver* observer, Stage stage) noexcept {
  if (observer != nullptr) {
    observer->ended(stage);
  }
}

std::size_t num_pixels(const WeldPipeline::Capacity& capacity) noexcept {
  return std::size_t{capacity.views.width} * capacity.views.height;
}

FrameStore::Capacity store_capacity(const WeldPipeline::Capacity& capacity) noexcept {
  return {.max_views = capacity.views.max_views, .max_pixels = num_pixels(capacity)};
}

bool is_sensible(const WeldPipeline::Config& config) noexcept {
  return config.fine_cell_mm >= 0.05 && config.coarse_cell_mm >= config.fine_cell_mm &&
         config.coarse_cell_mm <= 100.0 && config.region_margin_mm >= 0.0 &&
         std::isfinite(config.region_margin_mm);
}

/// Moves what a stage's make() gave to where it stays. Not inlined: a stage is a large object.
template <typename T>
[[gnu::noinline]] Result<> keep(const Result<T>& made, std::optional<T>& kept) noexcept {
  if (!made.ok()) {
    return made.error();
  }
  kept.emplace(made.value());
  return {};
}

cloud::OrientedBox box_of(const std::optional<RegionOfInterest>& region) noexcept {
  cloud::OrientedBox box;
  if (region) {
    const Eigen::Vector3f low = region->min_base.cast<float>();
    const Eigen::Vector3f high = region->max_base.cast<float>();
    box.low_mm = {low.x(), low.y(), low.z()};
    box.high_mm = {high.x(), high.y(), high.z()};
  }
  return box;
}

constexpr std::size_t kFinerVoxels = 5;  // At half the size; four, and some for the noise.

bool may_be_too_coarse(seam::Refusal refusal) noexcept {
  return refusal == seam::Refusal::kNoRing || refusal == seam::Refusal::kOneSurface ||
         refusal == seam::Refusal::kTwoRings || refusal == seam::Refusal::kLowCoverage;
}

bool stands(const splice::NetworkReport& network) noexcept {
  return network.state == splice::NetworkState::kAdjusted ||
         network.state == splice::NetworkState::kOneView;
}

bool any_used(std::span<const splice::SplicedView> views) noexcept {
  return std::any_of(views.begin(), views.end(), [](const splice::SplicedView& view) {
    return view.state == splice::ViewState::kUsed;
  });
}

}  // namespace

const char* name(ScanFault fault) noexcept {
  constexpr const char* kNames[] = {"None", "NoView", "Unspliced", "NotAdjusted", "MapFull"};
  return kNames[static_cast<std::uint8_t>(fault)];
}

std::size_t WeldPipeline::bytes(const Capacity& capacity) noexcept {
  return Arena::bytes<std::byte>(sizeof(WeldPipeline)) +
         FrameStore::bytes(store_capacity(capacity)) + SpliceChain::bytes(capacity.views) +
         cloud::FrameFuser::bytes(capacity.views.width) +
         cloud::VoxelMap::bytes(capacity.max_voxels) + SeamChain::bytes(capacity.seam) +
         Arena::bytes<splice::SplicedView>(capacity.views.max_views) +
         Arena::bytes<seam::SeamPoint>(capacity.max_seam_points) +
         Arena::bytes<std::uint8_t>(num_pixels(capacity));
}

WeldPipeline::WeldPipeline(Key /*key*/, const Config& config, const Capacity& capacity,
                           Arena& arena) noexcept
    : config_(config),
      capacity_(capacity),
      mask_(arena.take<std::uint8_t>(num_pixels(capacity))),
      views_(arena.take<splice::SplicedView>(capacity.views.max_views)),
      seam_points_(arena.take<seam::SeamPoint>(capacity.max_seam_points)) {}

Result<WeldPipeline*> WeldPipeline::make(const Config& config, const Capacity& capacity,
                                         Arena& arena) noexcept {
  if (!is_sensible(config)) {
    return Errc::kInvalidArgument;
  }
  const auto place = arena.take<std::byte>(sizeof(WeldPipeline));
  if (place.empty()) {
    return Errc::kOutOfMemory;
  }
  auto* pipeline = std::construct_at(
      reinterpret_cast<WeldPipeline*>(place.data()),  // NOLINT: the object begins here.
      Key{}, config, capacity, arena);
  const Result<> built = pipeline->build_stages(arena);
  if (!built.ok()) {
    return built.error();
  }
  return pipeline;
}

Result<> WeldPipeline::build_stages(Arena& arena) noexcept {
  const auto step_mm = static_cast<float>(config_.flying_step_mm);
  const auto cell_mm = static_cast<float>(config_.fine_cell_mm);
  Result<> built = keep(FrameStore::make(store_capacity(capacity_), arena), store_);
  built =
      built.ok() ? keep(SpliceChain::make(config_.splice, capacity_.views, arena), splice_) : built;
  built =
      built.ok()
          ? keep(cloud::FrameFuser::make({.max_step_mm = step_mm}, capacity_.views.width, arena),
                 fuser_)
          : built;
  built = built.ok()
              ? keep(cloud::VoxelMap::make({.cell_mm = cell_mm}, capacity_.max_voxels, arena), map_)
              : built;
  built = built.ok() ? keep(SeamChain::make(config_.seam, capacity_.seam, arena), seam_) : built;
  if (built.ok() && arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return built;
}

void WeldPipeline::clear() noexcept {
  store_->clear();
  splice_->clear();
  map_->clear();
  views_.clear();
  seam_points_.clear();
}

TakeInReport WeldPipeline::add(const depth::DepthImage& frame, const splice::ReportedPose& reported,
                               StageObserver* observer) noexcept {
  TakeInReport report;
  const Result<> kept = store_->add(frame);
  report.kept = kept.ok();
  if (kept.ok()) {
    report.view = splice_->add(store_->frames().back(), reported);
  } else {
    report.error = kept.error();
  }
  tell(observer, Stage::kTakeIn);
  return report;
}

WeldReport WeldPipeline::finish(StageObserver* observer) noexcept {
  WeldReport report;
  seam_points_.clear();
  if (store_->size() == 0) {
    return report;
  }
  report.network = splice_->finish(views_);
  tell(observer, Stage::kAdjust);
  report.fault = !any_used(views_.view())  ? ScanFault::kUnspliced
                 : !stands(report.network) ? ScanFault::kNotAdjusted
                                           : ScanFault::kNone;
  if (report.fault == ScanFault::kNone && find_coarsely(report, observer)) {
    find_finely(report, observer);
  }
  return report;
}

/// The ring in a coarse map of everything that was seen: it says where to look closely. A part too
/// small for the cells shows no ring in them, and is looked at again in finer ones.
bool WeldPipeline::find_coarsely(WeldReport& report, StageObserver* observer) noexcept {
  for (double cell_mm = config_.coarse_cell_mm;; cell_mm *= 0.5) {
    report.coarse = fuse(cell_mm, config_.region);
    tell(observer, Stage::kCoarseFuse);
    if (report.coarse.dropped_full > 0) {
      report.fault = ScanFault::kMapFull;
      return false;
    }
    SeamInput input = seam_input();
    input.frames = {};  // The coarse seam needs no edges.
    input.views = {};
    input.reference = seam::ReferenceCurve::kRoot;
    report.seam = seam_->run(input, seam_points_);
    tell(observer, Stage::kCoarseSeam);
    const std::size_t finer = kFinerVoxels * map_->size();
    const bool nothing = seam_points_.empty() && may_be_too_coarse(report.seam.refusal);
    if (!nothing || 0.5 * cell_mm < config_.fine_cell_mm ||
        finer > std::min(capacity_.max_voxels, capacity_.seam.max_points)) {
      return !seam_points_.empty();
    }
  }
}

/// The seam itself, from a fine map of its surroundings and from the frames.
void WeldPipeline::find_finely(WeldReport& report, StageObserver* observer) noexcept {
  const RegionOfInterest region =
      grown(region_around(seam_points_.view()), config_.region_margin_mm);
  const double cell_mm = affordable_cell_mm(
      count_inside(map_->view().points, region), config_.coarse_cell_mm, config_.fine_cell_mm,
      std::min(capacity_.max_voxels, capacity_.seam.max_points));
  report.fine = fuse(cell_mm, region);
  tell(observer, Stage::kFineFuse);
  seam_points_.clear();
  if (report.fine.dropped_full > 0) {
    report.fault = ScanFault::kMapFull;
    return;
  }
  SeamInput input = seam_input();
  input.region = region;
  report.seam = seam_->run(input, seam_points_);
  tell(observer, Stage::kSeam);
}

/// All used views into one map of cells of `cell_mm`, without the pixels of markers.
FuseReport WeldPipeline::fuse(double cell_mm,
                              const std::optional<RegionOfInterest>& region) noexcept {
  FuseReport report{.cell_mm = cell_mm};
  map_->relay(static_cast<float>(cell_mm), {});
  fuser_->set_box(box_of(region));
  for (std::size_t i = 0; i < views_.size(); ++i) {
    if (views_[i].state != splice::ViewState::kUsed) {
      continue;
    }
    const depth::DepthImage& frame = store_->frames()[i];
    const auto masked = mask_.first(frame.depth.size());
    mask_markers(splice_->markers(i), frame.intrinsics, masked);
    const auto fused = fuser_->run({frame, views_[i].T_base_camera, i, masked}, *map_);
    report.points += fused.map.inserted;
    report.dropped_full += fused.map.dropped_full;
  }
  report.voxels = static_cast<std::uint32_t>(map_->size());
  return report;
}

SeamInput WeldPipeline::seam_input() noexcept {
  return {.cloud_base = map_->view(),
          .frames = store_->frames(),
          .views = views_.view(),
          .region = config_.region,
          .expected_radius_mm = config_.expected_radius_mm};
}

}  // namespace dseam::pipeline
