// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "dseam/hal/sim/cell_config.hpp"
#include "support/accuracy/chi_squared.hpp"

namespace dseam::test {

/// One row of the table of splice errors, and what is asked of it.
struct SpliceRow {
  const char* name;
  std::uint32_t markers;
  double ovality_mm;
  bool without_reports;  ///< Markers or pipes alone must place the views.
  double median_mm;      ///< Of the splice error at the seam, over the seeds; 0: not asked.
  double p95_mm;         ///< Asked of 200 seeds and more.
};
[[nodiscard]] std::span<const SpliceRow> splice_rows() noexcept;

/// What came of one seed.
struct SpliceOutcome {
  bool spliced = false;  ///< All views; otherwise nothing below is set.
  double rms_mm = 0.0;
  double predicted_mm = 0.0;
  double views_nees = 0.0;  ///< Of all views about their mean, by their joint covariance,
  int views_dof = 0;        ///< which has as many degrees of freedom.
  double base_nees = 0.0;   ///< Six.
  bool has_base = false;
};
/// `shrink` divides the frame's width and height.
[[nodiscard]] SpliceOutcome splice_seed(const SpliceRow& row, std::uint64_t seed,
                                        std::uint32_t shrink);

/// All seeds of a row.
struct SpliceTable {
  std::vector<double> rms_mm;
  std::vector<double> predicted_mm;
  std::uint64_t worst_seed = 0;
  double worst_mm = 0.0;
  int refused = 0;
  NeesTally views;  ///< One value a scan.
  NeesTally bases;

  void add(std::uint64_t seed, const SpliceOutcome& outcome);
  void print(const SpliceRow& row) const;
  /// Whether the row's figures hold, as far as these seeds can tell.
  [[nodiscard]] bool holds(const SpliceRow& row) const;
};

}  // namespace dseam::test
