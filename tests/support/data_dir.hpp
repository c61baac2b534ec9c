// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace dseam::test {

/// Where the measured data lie: DSEAM_DATA_DIR, or ../shared/data beside the project.
[[nodiscard]] std::filesystem::path data_dir();

}  // namespace dseam::test
