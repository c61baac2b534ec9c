// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/hal/sim/scene.hpp"

namespace dseam::hal::sim {

/// The two parts that are welded. The shell is always body 0.
void add_workpiece(const CellConfig& config, Scene& scene);
/// Table, clamps, a second nozzle, bolt holes, tack welds and spatter, as far as asked for.
void add_clutter(const CellConfig& config, Scene& scene);
/// The marker discs, clear of each other, of the joint and of the clutter.
void add_markers(const CellConfig& config, Scene& scene);

}  // namespace dseam::hal::sim
