// SPDX-License-Identifier: Apache-2.0
// Runs on the bare microcontroller: a transform, an arena, and a stage in its own workspace.
#include <array>
#include <cmath>
#include <cstddef>

#include "dseam/base/arena.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/pipeline/scan_workspace.hpp"
#include "start.hpp"

namespace {

alignas(32) std::array<std::byte, 4096> lent_memory;

// A stage's whole memory as one static object: the budget is its type.
constexpr std::size_t kMaxCells = 200;
using Workspace = dseam::pipeline::ScanWorkspace<dseam::cloud::VoxelDownsample::bytes(kMaxCells) +
                                                 dseam::cloud::CloudBuffer::bytes(kMaxCells)>;
static_assert(sizeof(Workspace) <= 24U << 10U, "a tenth of a Cortex-M7's data memory");
Workspace workspace;

bool the_arena_lends_and_refuses() {
  dseam::Arena arena(lent_memory);
  const bool lent = arena.take<float>(512).size() == 512;
  const bool refused = arena.take<float>(1024).empty() && arena.exhausted();
  return lent && refused;
}

bool a_transform_and_its_inverse_cancel() {
  const dseam::geometry::RigidTransform T_a_b{dseam::geometry::rotation_exp({0.1, -0.7, 0.4}),
                                              {120.0, -35.0, 800.0}};
  const Eigen::Vector3d p_b(10.0, 20.0, 30.0);
  return ((T_a_b.inverse() * (T_a_b * p_b)) - p_b).norm() < 1e-9;
}

/// A plate of 1600 points on 100 cells, and as many points as there are cells beyond the room.
bool a_stage_runs_in_its_workspace_and_counts_what_did_not_fit() {
  constexpr int kSide = 40;
  static std::array<float, kSide * kSide> x;
  static std::array<float, kSide * kSide> y;
  static std::array<float, kSide * kSide> z;
  for (int i = 0; i < kSide * kSide; ++i) {
    x[static_cast<std::size_t>(i)] = static_cast<float>(i % kSide);
    y[static_cast<std::size_t>(i)] = static_cast<float>(i / kSide);
  }
  auto stage = dseam::cloud::VoxelDownsample::make({.cell_mm = 4.0F}, kMaxCells, workspace.arena());
  dseam::cloud::CloudBuffer cells(kMaxCells, workspace.arena());
  if (!stage.ok() || workspace.arena().exhausted()) {
    return false;
  }
  const bool fitted = stage.value().run({x, y, z}, cells).dropped_full == 0 && cells.size() == 100;
  for (float& coordinate : x) {
    coordinate *= 4.0F;
  }
  const auto overflow = stage.value().run({x, y, z}, cells);
  return fitted && overflow.cells == kMaxCells && overflow.dropped_full == 800;
}

}  // namespace

int dseam::target::run_checks() noexcept {
  const bool passed = the_arena_lends_and_refuses() && a_transform_and_its_inverse_cancel() &&
                      a_stage_runs_in_its_workspace_and_counts_what_did_not_fit();
  print(passed ? "target: PASS\n" : "target: FAIL\n");
  return passed ? 0 : 1;
}
