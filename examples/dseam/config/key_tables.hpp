// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/settings.hpp"

namespace dseam::program {

// The table of all keys, by what they are about.
[[nodiscard]] std::vector<Key> camera_keys(LiveSettings& live);
[[nodiscard]] std::vector<Key> cell_keys(hal::sim::CellConfig& config);
[[nodiscard]] std::vector<Key> motion_keys(pipeline::MotionChain::Config& config);
[[nodiscard]] std::vector<Key> session_keys(WeldRun::Config& config);

void append(std::vector<Key>& keys, const std::vector<Key>& more);

}  // namespace dseam::program
