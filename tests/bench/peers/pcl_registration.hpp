// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::bench {

/// What one of PCL's registrations made of two clouds.
struct Registration {
  std::string name;
  geometry::RigidTransform T_target_source;
  bool converged = false;
  double ms = 0.0;
};

/// PCL's ICP, GICP, point-to-plane ICP and NDT on the same clouds, from the same start.
[[nodiscard]] std::vector<Registration> register_with_pcl(const cloud::CloudView& source,
                                                          const cloud::CloudView& target,
                                                          const geometry::RigidTransform& start);

}  // namespace dseam::bench
