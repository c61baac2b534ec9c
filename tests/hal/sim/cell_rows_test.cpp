// SPDX-License-Identifier: Apache-2.0
#include "support/accuracy/cell_rows.hpp"

#include <gtest/gtest.h>

#include "dseam/hal/sim/cell.hpp"

namespace dseam::test {
namespace {

TEST(CellRows, every_row_can_be_built_with_every_seed) {
  for (const std::string_view row : cell_rows()) {
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      const auto config = cell_of_row(row, seed);

      ASSERT_TRUE(config) << row << ' ' << seed;
      EXPECT_EQ(hal::sim::fault_in(*config), nullptr) << row << ' ' << seed;
    }
  }
  EXPECT_FALSE(cell_of_row("no such row", 1));
}

TEST(CellRows, the_seam_is_in_the_middle_of_every_view) {
  for (const std::string_view row : cell_rows()) {
    auto config = *cell_of_row(row, 3);
    const auto cell = hal::sim::Cell::make(config).value();
    const auto seam = cell.seam();
    const depth::Intrinsics k = intrinsics(config.scanner);
    for (const auto& view : cell.views()) {
      const auto T_camera_base = view.T_base_camera.inverse();
      for (std::size_t i = 0; seam && i < seam->points.size(); i += 10) {
        const Eigen::Vector3d p = T_camera_base * seam->points[i].p;
        const double u = k.fx * p.x() / p.z() + k.cx;
        const double v = k.fy * p.y() / p.z() + k.cy;

        EXPECT_TRUE(u > 0.0 && u < k.width && v > 0.0 && v < k.height) << row;
      }
    }
  }
}

}  // namespace
}  // namespace dseam::test
