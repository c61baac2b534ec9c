// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::program {

/// How the measured points beside the seam lie about one fitted surface, bin by bin along the seam.
struct SurfaceProfile {
  std::vector<double> s_mm;       ///< Middle of the bin.
  std::vector<double> mean_mm;    ///< NaN where the bin is empty.
  std::vector<double> spread_mm;  ///< Standard deviation.
};

struct LoopProfile {
  SurfaceProfile shell;
  SurfaceProfile nozzle;
};

/// Which points belong to which surface: 0 shell, 1 nozzle, 2 neither. Within `tolerance_mm`.
[[nodiscard]] std::vector<std::uint8_t> surface_of_points(const cloud::CloudView& cloud_base,
                                                          const seam::JointReport& joint,
                                                          double tolerance_mm);

/// The points within `reach_mm` of the seam, binned by the seam point nearest in angle.
[[nodiscard]] LoopProfile loop_profile(const cloud::CloudView& cloud_base,
                                       const seam::SeamView& seam_base,
                                       const seam::JointReport& joint, double reach_mm);

}  // namespace dseam::program
