// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include "dseam/pipeline/seam_chain.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/joint_cloud.hpp"

namespace dseam::test {

/// A chain with memory of its own, and what its last run gave.
class SeamFinder {
 public:
  explicit SeamFinder(const pipeline::SeamChain::Config& config = {})
      : owner_(pipeline::SeamChain::bytes({})),
        chain_(pipeline::SeamChain::make(config, {}, owner_.arena()).value()),
        storage_(8192),
        points_(storage_) {}

  seam::SeamReport find(const pipeline::SeamInput& in) { return chain_.run(in, points_); }
  seam::SeamReport find(const JointCloud& cloud) {
    return find(pipeline::SeamInput{.cloud_base = cloud.view()});
  }

  [[nodiscard]] std::span<const seam::SeamPoint> points() const { return points_.view(); }
  [[nodiscard]] double worst_error(const std::vector<Eigen::Vector3d>& truth) const {
    double worst = 0.0;
    for (const seam::SeamPoint& point : points()) {
      worst = std::max(worst, distance_to(truth, point.p_base));
    }
    return worst;
  }

 private:
  ArenaOwner owner_;
  pipeline::SeamChain chain_;
  std::vector<seam::SeamPoint> storage_;
  Buffer<seam::SeamPoint> points_;
};

/// The joint of the paper.
inline JointCloudConfig paper_joint() {
  JointCloudConfig config;
  config.axis_angle_rad = 62.9 * std::numbers::pi / 180.0;
  config.eccentricity_mm = 1.4;
  return config;
}

}  // namespace dseam::test
