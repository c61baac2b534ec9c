// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/hal/sim/cell_config.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::campaign {

/// One row of the accuracy table: how it differs from the simulated scanner's defaults.
struct Row {
  const char* name;
  void (*change)(hal::sim::CellConfig& config);
  double rmse_mm;  ///< What is asked of all seeds together; 0: the part must be refused.
  double max_mm;
  double coverage;
};
extern const std::array<Row, 18> kRows;

/// What one seed of a row gave.
struct Outcome {
  seam::SeamReport report;
  double rms_mm = 0.0;
  double max_mm = 0.0;
  double coverage = 0.0;
  double true_gap_mm = 0.0;
  double nees_lateral = 0.0;  ///< Of one point, drawn by the seed.
  double nees_normal = 0.0;
  double mean_lateral_mm = 0.0;
  double mean_normal_mm = 0.0;
  double num_points = 0.0;
  double milliseconds = 0.0;
};

/// Scans the row's part with the seed, fuses the views with their true poses, finds the seam.
[[nodiscard]] Outcome run(const Row& row, std::uint64_t seed);

}  // namespace dseam::campaign
