// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/fused_scan.hpp"

#include "dseam/cloud/frame_fuser.hpp"

namespace dseam::test {
namespace {

constexpr std::size_t kMaxCells = 262144;

cloud::OrientedBox box_about(const Eigen::Vector3f& centre, float reach_mm) {
  cloud::OrientedBox box;
  box.low_mm = {centre.x() - reach_mm, centre.y() - reach_mm, centre.z() - reach_mm};
  box.high_mm = {centre.x() + reach_mm, centre.y() + reach_mm, centre.z() + reach_mm};
  return box;
}

}  // namespace

TrueScan::TrueScan(const hal::sim::Cell& cell) : renderings_(cell.views().size()) {
  for (std::size_t i = 0; i < cell.views().size(); ++i) {
    cell.scan(i, renderings_[i]);
    frames_.push_back(hal::sim::image_of(renderings_[i], cell.config().scanner));
    splice::SplicedView view;
    view.state = splice::ViewState::kUsed;
    view.T_base_camera = cell.views()[i].T_base_camera;
    views_.push_back(view);
  }
}

FusedScan::FusedScan(const hal::sim::Cell& cell, const TrueScan& scan, float cell_mm,
                     float reach_mm, float max_step_mm)
    : scan_(scan),
      owner_(cloud::VoxelMap::bytes(kMaxCells) +
             cloud::FrameFuser::bytes(cell.config().scanner.width)),
      map_(cloud::VoxelMap::make({.cell_mm = cell_mm}, kMaxCells, owner_.arena()).value()) {
  auto fuser = cloud::FrameFuser::make({.max_step_mm = max_step_mm}, cell.config().scanner.width,
                                       owner_.arena())
                   .value();
  fuser.set_box(box_about(cell.config().T_base_part.translation_mm.cast<float>(), reach_mm));
  for (std::size_t i = 0; i < scan.frames().size(); ++i) {
    (void)fuser.run({scan.frames()[i], scan.views()[i].T_base_camera, i, {}}, map_);
  }
}

pipeline::SeamInput FusedScan::input() {
  pipeline::SeamInput in;
  in.cloud_base = map_.view();
  in.frames = scan_.frames();
  in.views = scan_.views();
  return in;
}

}  // namespace dseam::test
