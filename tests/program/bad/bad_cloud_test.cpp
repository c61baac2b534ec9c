// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

/// One bad input: what lies in the file, and what the program's one line must say of it.
struct BadCloud {
  const char* name;
  std::string content;
  const char* fault;
};

std::string ply(const std::string& vertices, const std::string& body) {
  return "ply\nformat ascii 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + body;
}

std::string pcd(const std::string& points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
         "HEIGHT 1\nPOINTS " +
         points + "\nDATA " + data;
}

class BadCloudTest : public ::testing::TestWithParam<BadCloud> {
 protected:
  test::ScratchFolder scratch_;
};

TEST_P(BadCloudTest, is_named_in_one_line_and_leaves_nothing) {
  const std::string file = scratch_.write("cloud", GetParam().content);

  const Outcome outcome = run_program({"extract", file, "--out", scratch_.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_NE(outcome.text.find(file), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find(GetParam().fault), std::string::npos) << outcome.text;
  EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(scratch_.path("out")));
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadCloudTest,
    ::testing::Values(
        BadCloud{"empty_file", "", "neither a PLY nor a PCD"},
        BadCloud{"other_format", "solid x\n", "neither a PLY nor a PCD"},
        BadCloud{"header_does_not_end", "ply\nformat ascii 1.0\n", "the header does not end"},
        BadCloud{"no_points", ply("0", ""), "holds no points"},
        BadCloud{"truncated_ascii", ply("3", "1 2 3\n4 5 6\n"), "3 points announced, 2 found"},
        BadCloud{"short_row", ply("1", "1 2\n"), "too few numbers"},
        BadCloud{"not_a_number", ply("1", "1 two 3\n"), "'two' is not a number"},
        BadCloud{"all_nan", ply("2", "nan 1 2\n1 inf 2\n"), "holds no finite point"},
        BadCloud{"negative_count", ply("-1", ""), "is not a count"},
        BadCloud{"huge_count", ply("99999999999", ""), "too many points"},
        BadCloud{"no_z",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                 "property float y\nend_header\n1 2\n",
                 "has no field 'z'"},
        BadCloud{"truncated_binary", pcd("5", "binary\nabcdefghijklmn"), "5 points announced, 1"},
        BadCloud{"compressed", pcd("1", "binary_compressed\n"), "is not supported"},
        BadCloud{"zero_count",
                 "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 0 0 0\n"
                 "POINTS 1\nDATA binary\n",
                 "no sensible count"}),
    [](const auto& bad) { return std::string(bad.param.name); });

TEST(BadCloud, a_missing_file_is_named) {
  const test::ScratchFolder scratch;

  const Outcome outcome =
      run_program({"extract", scratch.path("none.ply"), "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("none.ply: cannot be read"), std::string::npos) << outcome.text;
}

TEST(BadCloud, one_point_is_refused_and_the_report_says_so) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("one.ply", ply("1", "1 2 3\n"));

  const Outcome outcome = run_program({"extract", file, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;
  EXPECT_EQ(scratch.names_in("out"),
            (std::set<std::string>{"merged.ply", "report.html", "report.json"}));
}

TEST(BadCloud, points_that_are_not_finite_are_left_out_and_counted) {
  const test::ScratchFolder scratch;
  const std::string file =
      scratch.write("some.ply", ply("4", "1 2 3\nnan 0 0\n4 -inf 6\n7 8 1e39\n"));

  const Outcome outcome = run_program({"extract", file, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3) << outcome.text;  // One point is left: no seam.
  std::ifstream in(scratch.path("out/report.json"));
  const auto report = nlohmann::json::parse(in);
  EXPECT_EQ(report["stages"][0]["counts"]["not finite"], 3.0);
  EXPECT_EQ(report["seam"]["cloud_points"], 1);
  EXPECT_EQ(report["verdict"]["weld"], false);
}

TEST(BadCloud, more_points_than_the_workspace_holds_are_refused) {
  const test::ScratchFolder scratch;
  std::string rows;
  for (int i = 0; i < 1001; ++i) {
    rows += std::to_string(i) + " 0 0\n";
  }
  const std::string file = scratch.write("many.ply", ply("1001", rows));

  const Outcome outcome =
      run_program({"extract", file, "--set", "job.max_points=1000", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.text.find("the workspace holds 1000"), std::string::npos) << outcome.text;
}

TEST(Output, an_old_seam_does_not_outlive_a_new_refusal) {
  const test::ScratchFolder scratch;
  std::filesystem::create_directory(scratch.path("out"));
  scratch.write("out/seam.csv", "old");
  scratch.write("out/notes.txt", "the user's own");
  const std::string file = scratch.write("one.ply", ply("1", "1 2 3\n"));

  const Outcome outcome = run_program({"extract", file, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(scratch.names_in("out"),
            (std::set<std::string>{"merged.ply", "notes.txt", "report.html", "report.json"}));
}

}  // namespace
}  // namespace dseam::program
