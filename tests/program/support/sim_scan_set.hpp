// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dseam/hal/replay/scan_set.hpp"
#include "dseam/hal/sim/cell.hpp"

namespace dseam::program::test {

/// A simulated cell whose frames have half the usual width and height.
[[nodiscard]] hal::sim::CellConfig half_size_cell();

using EditView = std::function<void(std::uint32_t, hal::replay::ScanView&)>;

/// Writes simulated frames as a scan set, with the poses the robot reports: the cells, which differ
/// in their views alone, take turns. `edit` may change each view before it is written.
void write_scan_set(const std::vector<hal::sim::CellConfig>& cells, const std::string& set,
                    const EditView& edit);

}  // namespace dseam::program::test
