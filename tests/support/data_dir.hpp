// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>

namespace dseam::test {

/// Where the measured data lie: DSEAM_DATA_DIR, or ../shared/data beside the project.
inline std::filesystem::path data_dir() {
  const char* named = std::getenv("DSEAM_DATA_DIR");
  return named != nullptr ? named : DSEAM_DEFAULT_DATA_DIR;
}

}  // namespace dseam::test
