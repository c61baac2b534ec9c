// SPDX-License-Identifier: Apache-2.0
// A stage by itself: its memory is lent before, and run() says what became of every point.
#include <array>
#include <cstdio>
#include <vector>

#include "dseam/cloud/voxel_downsample.hpp"

namespace {

using dseam::cloud::VoxelDownsample;

constexpr std::size_t kMaxCells = 200;
alignas(64) std::array<std::byte, 64U << 10U> memory;

}  // namespace

int main() {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  for (int row = 0; row < 100; ++row) {  // A plate of 99 x 99 mm, a point every millimetre.
    for (int column = 0; column < 100; ++column) {
      x.push_back(static_cast<float>(column));
      y.push_back(static_cast<float>(row));
      z.push_back(0.0F);
    }
  }
  dseam::Arena arena(memory);
  auto stage = VoxelDownsample::make({.cell_mm = 10.0F}, kMaxCells, arena);
  dseam::cloud::CloudBuffer cells(kMaxCells, arena);
  if (!stage.ok() || arena.exhausted()) {
    std::printf("the lent memory is too small\n");
    return 1;
  }

  const VoxelDownsample::Report report = stage.value().run({x, y, z}, cells);

  std::printf("%zu points became %zu; %u found no room\n", x.size(), cells.size(),
              report.dropped_full);
  return cells.size() == 100 ? 0 : 1;
}
