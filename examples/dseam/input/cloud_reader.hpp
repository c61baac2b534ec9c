// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "input/loaded_cloud.hpp"

namespace dseam::program {

/// More points than this are refused before any memory is taken for them.
inline constexpr std::size_t kMaxCloudPoints = 16'000'000;

/// Reads a PLY or PCD file, ascii or binary, by its content and not by its name.
///
/// Errors:  throws Failure(kInput) that names the file and the fault: missing, truncated, another
///          format, no x, y, z, no finite point, too many points.
[[nodiscard]] LoadedCloud read_cloud(const std::filesystem::path& file, double mm_per_unit);

/// Points of a CSV file: the first three columns are x, y, z; a header line is allowed.
[[nodiscard]] LoadedCloud read_csv_points(const std::filesystem::path& file, double mm_per_unit);

/// The whole file as bytes. Throws Failure(kInput).
[[nodiscard]] std::string read_bytes(const std::filesystem::path& file);

// The formats, given the file's bytes; throw std::runtime_error with the fault alone.
[[nodiscard]] LoadedCloud parse_ply(const std::string& bytes, double mm_per_unit);
[[nodiscard]] LoadedCloud parse_pcd(const std::string& bytes, double mm_per_unit);
[[nodiscard]] LoadedCloud parse_csv(const std::string& bytes, double mm_per_unit);

}  // namespace dseam::program
