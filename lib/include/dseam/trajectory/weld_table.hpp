// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dseam::trajectory {

/// One row of welding parameters.
struct WeldSchedule {
  double wire_feed_m_min = 6.0;
  double voltage_v = 20.0;
};

/// Welding parameters by schedule number; a pass names one row for its bead and one for its crater.
struct WeldTable {
  static constexpr std::size_t kMaxRows = 16;
  std::array<WeldSchedule, kMaxRows> rows{};
  std::uint8_t num_rows = 1;

  /// Rows past the end read as an arc with no feed and no voltage: nothing is made up.
  [[nodiscard]] constexpr WeldSchedule at(std::uint8_t schedule) const noexcept {
    return schedule < num_rows && schedule < kMaxRows ? rows[schedule] : WeldSchedule{0.0, 0.0};
  }
};

}  // namespace dseam::trajectory
