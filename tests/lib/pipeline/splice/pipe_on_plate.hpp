// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::test {

/// A cloud that owns its points, in mm.
struct OwnedCloud {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;

  void add(const Eigen::Vector3d& p) {
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
  }
  [[nodiscard]] cloud::CloudView view() const { return {x, y, z}; }
};

/// One of the measured scans of a pipe on a plate; empty where the data are absent.
[[nodiscard]] OwnedCloud measured_scan(const std::string& name);

/// Points spread over the triangles of the part's CAD mesh, and the triangles' normals.
struct MeshSamples {
  OwnedCloud points;
  OwnedCloud normals;
};
[[nodiscard]] MeshSamples mesh_samples(double spacing_mm);

}  // namespace dseam::test
