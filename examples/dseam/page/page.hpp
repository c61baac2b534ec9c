// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/job_report.hpp"

namespace dseam::program {

/// report.html: one page that needs nothing beside it.
[[nodiscard]] std::string page(const JobReport& job);

}  // namespace dseam::program
