// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "report/job_report.hpp"

namespace dseam::program {

/// report.json: counts and milliseconds by stage, quality, budget of errors, verdict. Angles are
/// in rad, lengths in mm. docs/formats.md has the schema.
[[nodiscard]] nlohmann::ordered_json report_json(const JobReport& job);
/// poses.json: `{"0": {"T_base_camera": [16, row-major], ...}, ...}`.
[[nodiscard]] nlohmann::ordered_json poses_json(std::span<const splice::SplicedView> views);

}  // namespace dseam::program
