// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dseam/calibration/hand_eye.hpp"

namespace dseam::program {

/// `[{"T_base_flange": [16], "T_camera_target": [16]}, ...]`, or an object of such by name.
///
/// Errors:  throws Failure(kInput) that names file, pair and fault.
[[nodiscard]] std::vector<calibration::PosePair> read_pairs(const std::filesystem::path& file);
/// The same of bytes that were read from `name`.
[[nodiscard]] std::vector<calibration::PosePair> parse_pairs(const std::string& bytes,
                                                             const std::string& name);

}  // namespace dseam::program
