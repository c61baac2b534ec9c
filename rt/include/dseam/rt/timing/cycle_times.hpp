// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/rt/timing/histogram.hpp"

namespace dseam::rt {

/// What the time of a cycle goes to.
///
/// Context: the cycle adds, any thread reads at any time.
struct CycleTimes {
  Histogram wake_up;        ///< From when a cycle was due to when it ran,
  Histogram compute;        ///< and from there to when it had nothing more to do.
  Histogram camera_to_bus;  ///< From a frame's exposure to what the cycle sent on account of it.
};

}  // namespace dseam::rt
