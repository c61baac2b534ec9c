// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/joint/joint_fit.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

/// Which angles about the nozzle were measured.
///
/// An angle is measured when trusted points of both surfaces lie there within 3 mm of the seam,
/// plus the joint's own dead band: what its median angle lacks.
class RingCoverage {
 public:
  static constexpr std::size_t kMaxBins = 360;

  void run(const JointFit& fit, const JointEdges& edges, double spacing_mm) noexcept;
  [[nodiscard]] bool measured_at(double phi_rad) const noexcept;
  /// How wide a gap may be of which no edge was seen: how much farther from the joint the shell
  /// begins than the nozzle does. A dead band takes as much of both; 0 within the points' spacing.
  [[nodiscard]] double hidden_gap_mm() const noexcept { return hidden_gap_mm_; }
  /// Width of the hole around an angle; 0 where it was measured.
  [[nodiscard]] double hole_at(double phi_rad) const noexcept;
  /// Fills coverage, largest hole and the list of holes.
  void report(bool counter_clockwise, SeamReport& report) const noexcept;

 private:
  using Distances = std::array<float, kMaxBins>;
  [[nodiscard]] std::size_t bin_of(double phi_rad) const noexcept;
  void collect(const JointFit::Side& side, const EdgeCurve* edge, Distances& nearest) noexcept;
  double median_of(const Distances& nearest) noexcept;

  std::size_t num_bins_ = 0;
  std::array<bool, kMaxBins> measured_{};
  Distances shell_{};
  Distances nozzle_{};
  Distances sorted_{};
  double hidden_gap_mm_ = 0.0;
};

}  // namespace dseam::seam
