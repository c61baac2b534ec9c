// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::splice {

/// Which motions a registration cannot see: sliding along a pipe, spinning about it, sliding and
/// turning on a plane. Found once, from the first normal equations, and held from then on.
///
/// Frame:   that of the normal equations; turns act about their pivot and count at `reach_mm`, so
///          that a direction is a motion of about one millimetre at the edge of what is seen.
struct Observability {
  double reach_mm = 1.0;
  std::uint32_t num_frozen = 0;
  /// Columns: unit motions (mm, mm at reach), the frozen ones first.
  geometry::Matrix6 directions = geometry::Matrix6::Identity();
  /// Mean squared change of a residual under each of them.
  geometry::Vector6 sensitivity = geometry::Vector6::Zero();

  /// The step -H^-1 g in the seen directions alone.
  [[nodiscard]] geometry::Vector6 solve(const geometry::Matrix6& h,
                                        const geometry::Vector6& g) const noexcept;
  /// The inverse of H in the seen directions; frozen ones have `frozen_variance`.
  [[nodiscard]] geometry::Matrix6 invert(const geometry::Matrix6& h,
                                         double frozen_variance) const noexcept;
};

/// `h` is the sum of J^T J over residuals with unit weights that add up to `sum_weight`.
[[nodiscard]] Observability find_frozen(const geometry::Matrix6& h, double sum_weight,
                                        double reach_mm, double min_sensitivity) noexcept;

}  // namespace dseam::splice
