// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::program {

/// Reads a JSON file. Throws Failure(kInput) with file, line and fault.
[[nodiscard]] nlohmann::json read_json(const std::filesystem::path& file);
/// The same of bytes that were read from `name`.
[[nodiscard]] nlohmann::json parse_json(const std::string& bytes, const std::string& name);

/// The rigid transform under `key`: 16 numbers row by row, or 4 rows of 4, in mm.
///
/// Errors:  throws Failure(kInput) that names `where`, the key and the fault: absent, another
///          shape, not finite, not rigid.
[[nodiscard]] geometry::RigidTransform rigid_at(const nlohmann::json& object, const char* key,
                                                const std::string& where);

}  // namespace dseam::program
