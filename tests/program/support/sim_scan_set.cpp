// SPDX-License-Identifier: Apache-2.0
#include "program/support/sim_scan_set.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace dseam::program::test {

hal::sim::CellConfig half_size_cell() {
  hal::sim::CellConfig config;
  config.scanner.width /= 2;
  config.scanner.height /= 2;
  return config;
}

void write_scan_set(const std::vector<hal::sim::CellConfig>& cells, const std::string& set,
                    const EditView& edit) {
  auto writer = hal::replay::ScanSetWriter::create(set);
  for (std::uint32_t i = 0; i < cells.front().views.count; ++i) {
    const hal::sim::Cell cell = hal::sim::Cell::make(cells[i % cells.size()]).value();
    hal::sim::Rendering rendering;
    cell.scan(i, rendering);
    hal::replay::ScanView view;
    view.camera.id = i;
    view.camera.intrinsics = intrinsics(cell.config().scanner);
    view.camera.mm_per_count = cell.config().scanner.mm_per_count;
    view.camera.T_base_camera = cell.views()[i].T_base_camera_reported;
    view.depth = std::move(rendering.depth);
    view.gray = std::move(rendering.gray);
    edit(i, view);
    EXPECT_FALSE(writer.value().add(view));
  }
  EXPECT_FALSE(writer.value().commit());
}

}  // namespace dseam::program::test
