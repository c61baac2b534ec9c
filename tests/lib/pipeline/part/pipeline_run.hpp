// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/pipeline/weld_pipeline.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {

/// One scan through a pipeline of its own, as the program runs it.
class PipelineRun {
 public:
  PipelineRun(std::span<const depth::DepthImage> frames,
              std::span<const splice::ReportedPose> reported)
      : memory_(pipeline::WeldPipeline::bytes(capacity_for(frames))),
        pipeline_(pipeline::WeldPipeline::make({}, capacity_for(frames), memory_.arena()).value()) {
    for (std::size_t v = 0; v < frames.size(); ++v) {
      (void)pipeline_->add(frames[v], reported[v]);
    }
    report_ = pipeline_->finish();
  }

  [[nodiscard]] const pipeline::WeldReport& report() const { return report_; }
  [[nodiscard]] std::span<const seam::SeamPoint> seam() const { return pipeline_->seam_points(); }
  [[nodiscard]] std::span<const splice::SplicedView> views() const { return pipeline_->views(); }

 private:
  static pipeline::WeldPipeline::Capacity capacity_for(std::span<const depth::DepthImage> frames) {
    pipeline::WeldPipeline::Capacity capacity;
    capacity.views.width = frames[0].intrinsics.width;
    capacity.views.height = frames[0].intrinsics.height;
    capacity.views.max_views = frames.size();
    capacity.max_voxels = 400000;
    capacity.seam.max_points = 400000;
    return capacity;
  }

  ArenaOwner memory_;
  pipeline::WeldPipeline* pipeline_;
  pipeline::WeldReport report_;
};

}  // namespace dseam::test
