// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "report/job_report.hpp"

namespace dseam::program {

// Each is empty when there is nothing to say.
[[nodiscard]] std::string warnings_list(const std::vector<std::string>& warnings);
[[nodiscard]] std::string budget_table(const std::vector<BudgetRow>& budget);
[[nodiscard]] std::string stage_table(const std::vector<StageRow>& stages);
[[nodiscard]] std::string view_table(std::span<const splice::SplicedView> views);
[[nodiscard]] std::string ring_table(const seam::SeamReport& report);
[[nodiscard]] std::string robot_table(
    const std::vector<std::pair<std::string, std::string>>& robot);

}  // namespace dseam::program
