// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/job_report.hpp"

namespace dseam::program {

/// What varies around the loop, and along the path in time; empty without a seam.
[[nodiscard]] std::string charts(const JobReport& job);

}  // namespace dseam::program
