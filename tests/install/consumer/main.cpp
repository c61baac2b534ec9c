// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>

#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/rt/weld_session.hpp"

dseam::seam::SeamReport find(const dseam::cloud::FusedCloudView& cloud_base,
                             dseam::Buffer<dseam::seam::SeamPoint>& seam);

int main() {
  std::array<dseam::seam::SeamPoint, 64> points;
  dseam::Buffer<dseam::seam::SeamPoint> seam(points);
  const dseam::seam::SeamReport report = find({}, seam);
  const bool has_cell = dseam::hal::sim::Cell::make({}).ok();
  std::printf("%s\n", name(report.refusal));
  return !report.weld() && has_cell ? 0 : 1;
}
