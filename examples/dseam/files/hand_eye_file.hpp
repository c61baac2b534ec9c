// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "dseam/calibration/hand_eye.hpp"

namespace dseam::program {

/// hand_eye.json: the calibration with its covariance, residuals, date, units and a checksum over
/// all of it. docs/formats.md has the schema.
[[nodiscard]] nlohmann::ordered_json hand_eye_json(const calibration::HandEye& calibrated);

/// What a job needs of a hand-eye file.
struct HandEyeFile {
  geometry::RigidTransform T_flange_camera;
  double expected_tool_mm = 0.0;
};

/// Refuses a transform whose camera sits in the middle of the flange: then it is in metres,
/// whatever the units are said to be.
///
/// Errors:  throws Failure(kInput), with `where` before the fault.
void check_scale(const geometry::RigidTransform& T_flange_camera, const std::string& where);

/// Errors:  throws Failure(kInput): unreadable, a checksum that does not match, other units than mm
///          and rad, no expected error, not rigid, or in metres.
[[nodiscard]] HandEyeFile read_hand_eye(const std::filesystem::path& file);
/// The same of bytes that were read from `name`.
[[nodiscard]] HandEyeFile parse_hand_eye(const std::string& bytes, const std::string& name);

}  // namespace dseam::program
