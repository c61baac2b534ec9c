// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

/// A plate with a round hole of 40 mm radius, 200 mm wide: the rim of the hole is the only inner
/// one.
std::string plate_with_a_hole() {
  std::ostringstream rows;
  int count = 0;
  for (int i = -100; i <= 100; ++i) {
    for (int j = -100; j <= 100; ++j) {
      if (std::hypot(i, j) >= 40.0) {
        rows << i << ' ' << j << " 5\n";
        ++count;
      }
    }
  }
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows.str();
}

TEST(PaperMethod, counts_its_stages_and_says_what_was_fitted) {
  const test::ScratchFolder scratch;
  const std::string cloud = scratch.write("plate.ply", plate_with_a_hole());

  const Outcome outcome =
      run_program({"extract", cloud, "--method", "paper", "--set", "paper.seam_min_x_mm=-60",
                   "--set", "paper.seam_max_x_mm=60", "--set", "paper.seam_min_y_mm=-60", "--set",
                   "paper.seam_max_y_mm=60", "--out", scratch.path("out")});

  EXPECT_NE(outcome.text.find("points of the scan's rim"), std::string::npos) << outcome.text;
  std::ifstream file(scratch.path("out") + "/report.json");
  std::stringstream report;
  report << file.rdbuf();
  EXPECT_NE(report.str().find("\"method\": \"paper\""), std::string::npos);
  EXPECT_NE(report.str().find("boundary points"), std::string::npos);
}

class MethodOf : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(MethodOf, a_command_without_it_says_which_one_has_it) {
  const test::ScratchFolder scratch;
  std::vector<std::string> arguments = GetParam();
  arguments.insert(arguments.end(), {"--method", "paper", "--out", scratch.path("out")});

  const Outcome outcome = run_program(arguments);

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("dseam extract has it"), std::string::npos) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
}

using Words = std::vector<std::string>;
INSTANTIATE_TEST_SUITE_P(Commands, MethodOf,
                         ::testing::Values(Words{"weld", "--camera", "sim"},
                                           Words{"fit", "points.csv"}, Words{"splice", "set"},
                                           Words{"calibrate", "pairs.json"}),
                         [](const auto& words) { return words.param.front(); });

TEST(PaperMethod, a_configuration_for_it_is_refused_by_weld_too) {
  const test::ScratchFolder scratch;

  const Outcome outcome = run_program(
      {"weld", "--camera", "sim", "--set", "job.method=paper", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("dseam extract has it"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace dseam::program
