// SPDX-License-Identifier: Apache-2.0
#include "spliced_scan.hpp"

#include <gtest/gtest.h>

#include "support/accuracy/seam_accuracy.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {

Scan scan(const hal::sim::CellConfig& config) {
  Scan out;
  out.config = config;
  const auto cell = hal::sim::Cell::make(config);
  out.renderings.resize(config.views.count);
  for (std::size_t v = 0; v < config.views.count; ++v) {
    cell.value().scan(v, out.renderings[v]);
    out.frames.push_back(hal::sim::image_of(out.renderings[v], config.scanner));
    out.reported.push_back({true, cell.value().views()[v].T_base_camera_reported});
    out.truth.push_back(cell.value().views()[v].T_base_camera);
  }
  out.seam = cell.value().seam().value_or(hal::sim::TruthCurve{});
  return out;
}

const Scan& marked_scan() {
  static const Scan kScan = scan({});
  return kScan;
}

const Scan& bare_scan() {
  static const Scan kScan = [] {
    hal::sim::CellConfig config;
    config.markers.count = 0;
    return scan(config);
  }();
  return kScan;
}

Spliced splice_all(std::span<const depth::DepthImage> frames,
                   std::span<const splice::ReportedPose> reported) {
  pipeline::SpliceChain::Capacity capacity;
  ArenaOwner owner(pipeline::SpliceChain::bytes(capacity));
  auto chain = pipeline::SpliceChain::make({}, capacity, owner.arena());
  std::vector<splice::SplicedView> storage(cloud::kMaxViews);
  Buffer<splice::SplicedView> out(storage);

  const AllocationCounter allocations;
  const splice::NetworkReport report = chain.value().run(frames, reported, out);
  EXPECT_EQ(allocations.count(), 0U);

  return {report, {out.view().begin(), out.view().end()}};
}

double splice_error_mm(const Scan& scan, const Spliced& spliced) {
  std::vector<ViewPoses> poses;
  for (std::size_t v = 0; v < spliced.views.size(); ++v) {
    if (spliced.views[v].state == splice::ViewState::kUsed) {
      poses.push_back({scan.truth[v], spliced.views[v].T_base_camera});
    }
  }
  return splice_error(poses, scan.seam).rms_mm;
}

}  // namespace dseam::test
