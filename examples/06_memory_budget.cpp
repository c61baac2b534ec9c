// SPDX-License-Identifier: Apache-2.0
// What every stage asks for, before it is asked: bytes() of a capacity. The output is the table of
// docs/memory-budget.md.
#include <cstdio>

#include "dseam/pipeline/motion_chain.hpp"
#include "dseam/pipeline/paper_pipeline.hpp"
#include "dseam/pipeline/weld_pipeline.hpp"

namespace {

using namespace dseam;  // NOLINT(google-build-using-namespace): a table of many names.

void row(const char* stage, const char* capacity, std::size_t size_bytes) {
  std::printf("| %s | %s | %zu | %.2f |\n", stage, capacity, size_bytes,
              static_cast<double>(size_bytes) / (1U << 20U));
}

void scan_rows() {
  const pipeline::FrameStore::Capacity frames{.max_views = 6, .max_pixels = 1296U * 966U};
  row("`pipeline::FrameStore`", "6 frames of 1296 x 966", pipeline::FrameStore::bytes(frames));
  row("`pipeline::SpliceChain`", "6 views of 1296 x 966",
      pipeline::SpliceChain::bytes({.max_views = 6}));
  row("`cloud::FrameFuser`", "1296 columns", cloud::FrameFuser::bytes(1296));
  row("`cloud::VoxelMap`", "600 000 voxels", cloud::VoxelMap::bytes(600'000));
  row("`pipeline::SeamChain`", "600 000 points",
      pipeline::SeamChain::bytes({.max_points = 600'000}));
  row("`pipeline::SeamChain`", "100 000 points",
      pipeline::SeamChain::bytes({.max_points = 100'000}));
}

void core_rows() {
  row("`search::GridIndex`", "100 000 points", search::GridIndex::bytes(100'000));
  row("`cloud::OutlierRemoval`", "100 000 points", cloud::OutlierRemoval::bytes(100'000));
  row("`cloud::VoxelDownsample`", "100 000 cells", cloud::VoxelDownsample::bytes(100'000));
  row("`cloud::NormalsBuffer`", "100 000 points", cloud::NormalsBuffer::bytes(100'000));
  row("`seam::BoundaryTest` and its buffer", "100 000 points",
      seam::BoundaryTest::bytes() + seam::BoundaryBuffer::bytes(100'000));
  row("`seam::ClosedCurveFit`", "1 000 points", seam::ClosedCurveFit::bytes(1000));
}

void whole_rows() {
  pipeline::WeldPipeline::Capacity capacity;
  capacity.views.max_views = 6;
  capacity.seam.max_points = capacity.max_voxels;
  row("**`pipeline::WeldPipeline`**, all of a scan", "6 frames of 1296 x 966, 600 000 voxels",
      pipeline::WeldPipeline::bytes(capacity));
  row("**`pipeline::MotionChain`**, all of a path", "4096 seam points, 32 768 path points",
      pipeline::MotionChain::bytes({}));
  row("`pipeline::PaperPipeline`", "120 887 points", pipeline::PaperPipeline::bytes(120'887));
}

}  // namespace

int main() {
  std::printf("| stage | capacity | bytes | MiB |\n| --- | --- | ---: | ---: |\n");
  whole_rows();
  scan_rows();
  core_rows();
}
