// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/joint/ring_finder.hpp"
#include "dseam/seam/surface/cell_map.hpp"

namespace dseam::seam {

/// What lies around a ring, bin by bin of the angle about the nozzle.
struct RingSupport {
  using Counts = std::array<std::uint16_t, RingFinder::kBins>;
  Counts shell_outside{};
  Counts nozzle_above{};
  Counts nozzle_below{};
};

/// A cell tells of the ring `half_cell_mm` to both sides of its mean.
[[nodiscard]] RingSupport support_of(std::span<const Cell> cells, const Joint& joint,
                                     const NozzleFrame& frame, const CellScale& scale,
                                     double half_cell_mm) noexcept;

}  // namespace dseam::seam
