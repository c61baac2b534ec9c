// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "dseam/torch/path_planner.hpp"
#include "dseam/trajectory/set_point.hpp"

namespace dseam::program {

/// Where the arc went off before its time, in the terms of the keys of [resume].
struct BrokenBead {
  std::uint8_t pass = 0;
  double stopped_mm = 0.0;  ///< From the pass' start, to within the weave.

  /// What takes the bead up again, as the command line has it.
  [[nodiscard]] std::string resume_options() const;
};

/// Of the set points that were executed; nothing where the arc never burned.
[[nodiscard]] std::optional<BrokenBead> broken_bead(trajectory::SetPointView executed,
                                                    const torch::TorchCurveView& curve,
                                                    const torch::PathPlanner::Config& path);

}  // namespace dseam::program
