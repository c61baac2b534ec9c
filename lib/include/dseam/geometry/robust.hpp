// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace dseam::geometry {

/// Tukey's weight of a residual that is `scaled` = residual / cut: 0 from 1 on.
[[nodiscard]] constexpr double tukey(double scaled) noexcept {
  const double inside = 1.0 - scaled * scaled;
  return inside > 0.0 ? inside * inside : 0.0;
}

/// The cut for Tukey's weights, 4.685 sigma (95 % efficient), from the median absolute residual.
///
/// Shape:   `magnitudes`, at least one, come back in another order.
/// Units:   mm
[[nodiscard]] double tukey_cut_mm(std::span<float> magnitudes) noexcept;

}  // namespace dseam::geometry
