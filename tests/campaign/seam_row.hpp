// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "dseam/hal/sim/cell_config.hpp"

namespace dseam::campaign {

enum class Poses : std::uint8_t { kTrue, kSpliced };

/// One row of the accuracy table: how it differs from the simulated scanner's defaults.
struct Row {
  const char* name;
  void (*change)(hal::sim::CellConfig& config);
  Poses poses;
  double rmse_mm;  ///< What is asked of all seeds together; 0: the part must be refused.
  double max_mm;
  double coverage;

  [[nodiscard]] bool weldable() const noexcept { return rmse_mm > 0.0; }
};
extern const std::array<Row, 22> kRows;

/// The row's part and scan with this seed.
[[nodiscard]] hal::sim::CellConfig cell_of(const Row& row, std::uint64_t seed);

}  // namespace dseam::campaign
