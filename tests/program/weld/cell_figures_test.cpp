// SPDX-License-Identifier: Apache-2.0
#include "program/support/cell_figures.hpp"

#include <gtest/gtest.h>

#include <ostream>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

constexpr double kMinCoverage = 0.99;
constexpr double kMaxRmseMm = 0.10;

/// One part on which the figures of the simulated cell are stated.
struct Part {
  const char* name;
  std::vector<std::string> keys;
};

void PrintTo(const Part& part, std::ostream* out) { *out << part.name; }

const std::vector<Part>& parts() {
  static const std::vector<Part> kParts = {
      {"defaults", {}},
      {"axes_at_65_degrees", {"cell.axis_angle_rad=1.1344640137963142"}},
      {"eccentric_15_mm", {"cell.eccentricity_mm=15"}},
      {"no_gap", {"cell.gap_mm=0"}},
      {"gap_3_mm", {"cell.gap_mm=3"}}};
  return kParts;
}

test::Outcome weld(const test::ScratchFolder& scratch, const Part& part, int seed) {
  std::vector<std::string> arguments = {"weld", "--camera", "sim", "--set",
                                        "cell.seed=" + std::to_string(seed)};
  for (const std::string& key : part.keys) {
    arguments.insert(arguments.end(), {"--set", key});
  }
  arguments.insert(arguments.end(),
                   {"--truth", scratch.path("truth"), "--out", scratch.path("out")});
  return test::run_program(arguments);
}

void expect_figures(const Part& part, int first_seed, int last_seed) {
  std::vector<dseam::test::SeamAccuracy> runs;
  double least_coverage = 1.0;
  for (int seed = first_seed; seed <= last_seed; ++seed) {
    const test::ScratchFolder scratch;
    const test::Outcome outcome = weld(scratch, part, seed);
    ASSERT_EQ(outcome.exit_code, 0) << "seed " << seed << '\n' << outcome.text;
    runs.push_back(test::score_weld(scratch.path("out"), scratch.path("truth")));
    least_coverage = std::min(least_coverage, runs.back().coverage);
    EXPECT_GE(runs.back().coverage, kMinCoverage) << "seed " << seed;
    EXPECT_LE(runs.back().rmse_mm, 2.0 * kMaxRmseMm) << "seed " << seed;
  }
  const double rmse_mm = dseam::test::pooled_rmse_mm(runs);
  std::printf("%s, seeds %d to %d: rmse %.3f mm, least coverage %.2f %%\n", part.name, first_seed,
              last_seed, rmse_mm, 100.0 * least_coverage);
  EXPECT_LE(rmse_mm, kMaxRmseMm);
}

class CellFigures : public ::testing::TestWithParam<Part> {};

TEST_P(CellFigures, the_seam_of_one_seed_is_covered_and_within_a_tenth) {
  expect_figures(GetParam(), 1, 1);
}

INSTANTIATE_TEST_SUITE_P(Parts, CellFigures, ::testing::ValuesIn(parts()),
                         [](const auto& part) { return std::string(part.param.name); });

class LongCellFigures : public ::testing::TestWithParam<Part> {};

TEST_P(LongCellFigures, the_seams_of_five_seeds_are_covered_and_within_a_tenth) {
  expect_figures(GetParam(), 1, 5);
}

INSTANTIATE_TEST_SUITE_P(Parts, LongCellFigures, ::testing::ValuesIn(parts()),
                         [](const auto& part) { return std::string(part.param.name); });

}  // namespace
}  // namespace dseam::program
