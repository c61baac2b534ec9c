// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/seam_row.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::campaign {

/// What one seed of a row gave.
struct Outcome {
  seam::SeamReport report;
  double rms_mm = 0.0;  ///< On the measured part, as all that follows.
  double max_mm = 0.0;
  double coverage = 0.0;
  double num_points = 0.0;
  double true_gap_mm = 0.0;
  double nees_lateral = 0.0;  ///< Of one point, drawn by the seed.
  double nees_normal = 0.0;
  double mean_lateral_mm = 0.0;
  double mean_normal_mm = 0.0;
  double milliseconds = 0.0;  ///< Of the seam chain alone; of everything where views are spliced.
};

/// The simulated scanner as it is, or one for each scan: its depth bowl drawn, the default's size
/// being the standard deviation. Errors that scans share make no independent scans of them.
enum class Scanner { kDefault, kDrawn };

/// Scans the part with frames of 1296 by 966 pixels over `shrink` each way, finds its seam with the
/// row's poses, and scores it by the truth.
[[nodiscard]] Outcome run(const Row& row, std::uint64_t seed, std::uint32_t shrink = 1,
                          Scanner scanner = Scanner::kDefault);

}  // namespace dseam::campaign
