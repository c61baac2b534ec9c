// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/splice/icp.hpp"
#include "peers/pcl_registration.hpp"
#include "support/arena_owner.hpp"

namespace dseam::bench {

/// A frame's points without the table, on a lattice of 2.5 mm, camera frame.
class VoxelCloud {
 public:
  VoxelCloud(const depth::DepthImage& image, double farthest_mm);
  [[nodiscard]] cloud::CloudView view() const { return points_.view(); }

 private:
  test::ArenaOwner owner_;
  cloud::CloudBuffer points_;
};

/// Two neighbouring views of the simulated part without markers, and a start that is 2 mm and half
/// a degree off.
class ViewPair {
 public:
  explicit ViewPair(std::uint64_t seed);

  [[nodiscard]] cloud::CloudView source() const { return source_->view(); }
  [[nodiscard]] cloud::CloudView target() const { return target_->view(); }
  [[nodiscard]] const depth::DepthImage& source_image() const { return source_image_; }
  [[nodiscard]] const depth::DepthImage& target_image() const { return target_image_; }
  [[nodiscard]] const geometry::RigidTransform& start() const { return start_; }
  /// Displacement of the true seam: the root mean square of each base axis, and the largest.
  struct Error {
    Eigen::Vector3d rms_mm = Eigen::Vector3d::Zero();
    double max_mm = 0.0;
  };
  [[nodiscard]] Error error_of(const geometry::RigidTransform& T_target_source) const;

 private:
  hal::sim::Cell cell_;
  hal::sim::Rendering first_;
  hal::sim::Rendering second_;
  depth::DepthImage target_image_;
  depth::DepthImage source_image_;
  std::unique_ptr<VoxelCloud> target_;
  std::unique_ptr<VoxelCloud> source_;
  geometry::RigidTransform start_;
};

/// By our ICP, index and normals of the target included.
[[nodiscard]] Registration by_our_icp(const ViewPair& pair, splice::IcpMetric metric);
/// By the surface patches that a scan is spliced by, found in both frames.
[[nodiscard]] Registration by_our_patches(const ViewPair& pair);

}  // namespace dseam::bench
