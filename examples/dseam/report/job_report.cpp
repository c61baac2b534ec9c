// SPDX-License-Identifier: Apache-2.0
#include "report/job_report.hpp"

#include <array>
#include <cmath>

namespace dseam::program {

const char* name(splice::ViewState state) noexcept {
  constexpr std::array kNames{"used",  "no overlap", "contradicts", "unobservable",
                              "empty", "duplicate",  "ambiguous"};
  static_assert(kNames.size() == splice::kNumViewStates);
  return kNames[static_cast<std::size_t>(state)];
}

double total_sigma_mm(const std::vector<BudgetRow>& budget) {
  double sum = 0.0;
  for (const BudgetRow& row : budget) {
    sum += row.sigma_mm * row.sigma_mm;
  }
  return std::sqrt(sum);
}

}  // namespace dseam::program
