// SPDX-License-Identifier: Apache-2.0
// From the frames of a scan to its seam. The simulated cell stands for camera and robot; what
// follows is what a controller does with its own.
#include <cstdio>
#include <memory>

#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/weld_pipeline.hpp"

namespace {

using dseam::pipeline::WeldPipeline;

}  // namespace

int main() {
  const auto cell = dseam::hal::sim::Cell::make({}).value();
  const std::size_t num_views = cell.views().size();
  WeldPipeline::Capacity capacity;
  capacity.views.max_views = num_views;
  capacity.seam.max_points = capacity.max_voxels;

  // All the memory there will ever be, in one piece.
  const std::size_t size_bytes = WeldPipeline::bytes(capacity);
  const auto memory = std::make_unique_for_overwrite<std::byte[]>(size_bytes);
  dseam::Arena arena(std::span(memory.get(), size_bytes));
  const auto made = WeldPipeline::make({}, capacity, arena);
  if (!made.ok()) {
    return 1;
  }
  WeldPipeline& pipeline = *made.value();

  dseam::hal::sim::Rendering rendering;
  for (std::size_t view = 0; view < num_views; ++view) {
    cell.scan(view, rendering);
    pipeline.add(image_of(rendering, cell.config().scanner),
                 {true, cell.views()[view].T_base_camera_reported});
  }
  const dseam::pipeline::WeldReport report = pipeline.finish();

  std::printf("verdict %s; %zu points, %.1f mm long, %.1f %% of it measured, in %zu MiB\n",
              name(report.seam.refusal), pipeline.seam_points().size(), report.seam.length_mm,
              100.0 * report.seam.quality.coverage, size_bytes >> 20U);
  return report.weld() ? 0 : 1;
}
