// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "dseam/calibration/hand_eye.hpp"

namespace dseam::program {

/// Stations for a hand-eye calibration from a scan set of something that does not move: its markers
/// and surfaces, spliced without any help of the robot, are the target.
///
/// Errors:  throws Failure(kInput): an unreadable set, a view without T_base_flange, more views
/// than
///          can be spliced at once, fewer than three of them spliced.
[[nodiscard]] std::vector<calibration::PosePair> read_stations(const std::filesystem::path& set);

}  // namespace dseam::program
