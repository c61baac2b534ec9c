// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace dseam::program {

/// From now on SIGINT and SIGTERM only set the flag that is returned; the work in hand looks at it
/// and ends in order: arc off first, then motion, then the program. A second one ends at once.
const std::atomic<bool>& watch_for_interrupt();

}  // namespace dseam::program
