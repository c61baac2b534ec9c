// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "dseam/seam/edge/edge_curve.hpp"
#include "dseam/seam/joint/residual_model.hpp"

namespace dseam::seam {

/// What the nozzle's fit is off by and the edge's curve does not take up.
///
/// The edge is told by its distance from the nozzle. Of an error of the nozzle the curve takes up
/// what its own few harmonics can be; the rest displaces the seam.
///
/// Units:   errors in mm, as sums of independent ones.
/// Memory:  4 kB, in place.
/// Time:    O(order) a call.
class UnfollowedError {
 public:
  void reset(std::size_t order) noexcept;
  /// One of several places evenly round the turn.
  void add(double phi_rad, const ResidualModel::Row& errors) noexcept;
  [[nodiscard]] double variance_at(double phi_rad, const ResidualModel::Row& errors) const noexcept;

 private:
  std::size_t order_ = 0;
  double count_ = 0.0;
  std::array<ResidualModel::Row, EdgeCurve::kMaxOrder> sums_{};
};

}  // namespace dseam::seam
