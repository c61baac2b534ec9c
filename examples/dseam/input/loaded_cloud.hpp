// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "dseam/cloud/cloud.hpp"

namespace dseam::program {

/// Points of a file, in mm; the file says in which frame.
struct LoadedCloud {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  std::size_t num_not_finite = 0;  ///< Left out.

  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] cloud::CloudView view() const { return {x, y, z}; }
  /// Leaves out, and counts, what is not finite.
  void add(double x_mm, double y_mm, double z_mm);
};

}  // namespace dseam::program
