// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/hal/sim/cell.hpp"

namespace dseam::bench {

/// What two cameras side by side see of the simulated part, rectified and perfectly calibrated:
/// brushed and stained steel under a lamp beside the left camera, with highlights that wander.
struct StereoPair {
  std::uint32_t width = 0;
  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
  std::vector<float> left_z_mm;  ///< True depth of the left pixels; 0 where nothing is.
};

/// The left camera stands where view `view` of the cell was really taken.
[[nodiscard]] StereoPair render_stereo(const hal::sim::Cell& cell, std::size_t view,
                                       double baseline_mm);

}  // namespace dseam::bench
