// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/cloud/cloud.hpp"

namespace dseam::search {

/// Where a point lies on the space-filling curve.
struct CurvePlace {
  std::uint32_t key;
  std::uint32_t index;
};

inline constexpr std::size_t kCurveCounters = 3 * 1024;

/// Sorts the points named in `places` along a Hilbert curve over a grid of 1024 cells an axis.
/// Cells that hold more than `max_in_cell` points are sorted again over a grid of their own, and so
/// on, until they are small or their points are identical: an outlier coarsens nothing.
///
/// Shape:   indices rising, in bounds and of finite points; `spare` as long as `places`;
///          `counters` of kCurveCounters. Identical points keep their order.
/// Time:    linear for each refinement; a float has room for 20 of them.
/// Source:  J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004).
void sort_along_curve(const cloud::CloudView& cloud, std::size_t max_in_cell,
                      std::span<CurvePlace> places, std::span<CurvePlace> spare,
                      std::span<std::uint32_t> counters) noexcept;

}  // namespace dseam::search
