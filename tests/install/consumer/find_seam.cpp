// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/scan_workspace.hpp"
#include "dseam/pipeline/seam_chain.hpp"

static dseam::pipeline::ScanWorkspace<64U << 20U> workspace;  // All that the library takes.

dseam::seam::SeamReport find(const dseam::cloud::FusedCloudView& cloud_base,
                             dseam::Buffer<dseam::seam::SeamPoint>& seam) {
  static auto chain =
      dseam::pipeline::SeamChain::make({}, {.max_points = 100'000}, workspace.arena());
  return chain.ok() ? chain.value().run({.cloud_base = cloud_base}, seam)
                    : dseam::seam::SeamReport{};
}
