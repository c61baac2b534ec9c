// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "dseam/hal/sim/cell_config.hpp"

namespace dseam::test {

/// The kinds of workpiece and scan in which figures are stated. Each row's cells differ by seed in
/// everything that the row does not fix: radii, walls, angle, eccentricity, gap, places.
[[nodiscard]] std::span<const std::string_view> cell_rows() noexcept;

/// One cell of a row; none for a name that is no row. Every cell can be built.
[[nodiscard]] std::optional<hal::sim::CellConfig> cell_of_row(std::string_view row,
                                                              std::uint64_t seed);

}  // namespace dseam::test
