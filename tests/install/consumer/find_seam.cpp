// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/seam_chain.hpp"

alignas(64) static std::array<std::byte, 64U << 20U> memory;  // All that the library takes.

dseam::seam::SeamReport find(const dseam::cloud::FusedCloudView& cloud_base,
                             dseam::Buffer<dseam::seam::SeamPoint>& seam) {
  dseam::Arena arena(memory);
  auto chain = dseam::pipeline::SeamChain::make({}, {.max_points = 100'000}, arena);
  return chain.ok() ? chain.value().run({.cloud_base = cloud_base}, seam)
                    : dseam::seam::SeamReport{};
}
