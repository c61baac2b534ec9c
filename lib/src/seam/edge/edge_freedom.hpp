// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/seam/edge/edge_curve.hpp"

namespace dseam::seam {

/// Where all intervals together leave an edge free, beside what each of its sectors does.
///
/// Where every pixel at an edge flies, no interval ends near it: the edge may be anywhere in
/// between. And where many end on the wrong side they are no ends of an edge: it may be anywhere in
/// them. Wrong ones by chance are too few to count.
struct EdgeFreedom {
  double width_mm = 0.0;      ///< Of the band in which the edge may be anywhere.
  double to_middle_mm = 0.0;  ///< From the curve to the band's middle.
};

[[nodiscard]] EdgeFreedom freedom_of(const EdgeCurve& curve,
                                     std::span<const EdgeInterval> intervals) noexcept;

}  // namespace dseam::seam
