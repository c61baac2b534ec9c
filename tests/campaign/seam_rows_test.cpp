// SPDX-License-Identifier: Apache-2.0
// Every row of the seam's table of figures on three seeds, with frames of half the size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "campaign/seam_run.hpp"

namespace dseam::campaign {
namespace {

constexpr std::uint32_t kShrink = 2;

std::string spoken(const testing::TestParamInfo<Row>& info) {
  std::string name = info.param.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '.'; }, '_');
  return name;
}

class SeamRow : public testing::TestWithParam<Row> {};

TEST_P(SeamRow, keeps_its_figures) {
  const Row& row = GetParam();
  double squares = 0.0;
  double points = 0.0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Outcome outcome = run(row, seed, kShrink);

    EXPECT_EQ(outcome.report.weld(), row.weldable()) << seam::name(outcome.report.refusal);
    if (row.weldable()) {
      EXPECT_GE(outcome.coverage, row.coverage) << "seed " << seed;
      EXPECT_LE(outcome.max_mm, row.max_mm) << "seed " << seed;
      EXPECT_LE(outcome.rms_mm, 2.0 * row.rmse_mm) << "seed " << seed;
    }
    squares += outcome.rms_mm * outcome.rms_mm * outcome.num_points;
    points += outcome.num_points;
  }
  if (row.weldable()) {
    EXPECT_LE(std::sqrt(squares / std::max(1.0, points)), row.rmse_mm);
  }
}

INSTANTIATE_TEST_SUITE_P(Figures, SeamRow, testing::ValuesIn(kRows), spoken);

}  // namespace
}  // namespace dseam::campaign
