// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "dseam/pipeline/open_seam_chain.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/plate_cloud.hpp"

namespace dseam::test {

/// A chain with memory of its own, and what its last run gave.
class OpenSeamFinder {
 public:
  explicit OpenSeamFinder(const pipeline::OpenSeamChain::Config& config = {},
                          std::size_t room = 8192)
      : owner_(pipeline::OpenSeamChain::bytes({})),
        chain_(pipeline::OpenSeamChain::make(config, {}, owner_.arena()).value()),
        storage_(room),
        points_(storage_) {}

  seam::SeamReport find(const pipeline::SeamInput& in) { return chain_.run(in, points_); }
  seam::SeamReport find(const PlateCloud& cloud) {
    return find(pipeline::SeamInput{.cloud_base = cloud.view()});
  }

  [[nodiscard]] std::span<const seam::SeamPoint> points() const { return points_.view(); }
  [[nodiscard]] double worst_error(const PlateCloud& cloud) const {
    double worst = 0.0;
    for (const seam::SeamPoint& point : points()) {
      worst = std::max(worst, cloud.distance(point.p_base));
    }
    return worst;
  }
  /// Of the two ends, along the seam.
  [[nodiscard]] double worst_end_error(const PlateCloud& cloud,
                                       const PlateCloudConfig& config) const {
    double worst = 0.0;
    for (const double s : {-0.5 * config.length_mm, 0.5 * config.length_mm}) {
      const Eigen::Vector3d end = cloud.seam_at(s);
      const double first = (points().front().p_base - end).head<2>().norm();
      worst = std::max(worst, std::min(first, (points().back().p_base - end).head<2>().norm()));
    }
    return worst;
  }

 private:
  ArenaOwner owner_;
  pipeline::OpenSeamChain chain_;
  std::vector<seam::SeamPoint> storage_;
  Buffer<seam::SeamPoint> points_;
};

}  // namespace dseam::test
