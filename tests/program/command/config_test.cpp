// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

TEST(Config, what_it_prints_loads_again_and_is_the_same) {
  const test::ScratchFolder scratch;
  const Outcome printed = run_program({"config", "--print"});
  const std::string file = scratch.write("dseam.toml", printed.text);

  const Outcome again = run_program({"config", "--print", "--config", file});

  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.text, printed.text);
}

TEST(Config, each_fault_is_named_with_its_line_and_what_is_allowed) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("bad.toml",
                                         "[seam]\n"
                                         "min_coverage = 1.5\n"
                                         "refrence = \"root\"\n"
                                         "reference = \"rot\"\n"
                                         "max_hole_rad = \"wide\"\n"
                                         "[sem]\n"
                                         "x = 1\n");

  const Outcome outcome = run_program({"config", "--config", file});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.text,
            "dseam: " + file + ":2: 'seam.min_coverage' cannot be 1.5; allowed: 0 to 1\n" +
                "dseam: " + file + ":3: unknown key 'seam.refrence'\n" + "dseam: " + file +
                ":4: 'seam.reference' cannot be 'rot'; allowed: shell_edge, root, gap_middle or "
                "nozzle_edge\n" +
                "dseam: " + file +
                ":5: 'seam.max_hole_rad' cannot be 'wide'; allowed: 0 to 6.28319 rad\n" +
                "dseam: " + file + ":6: unknown section or key 'sem'\n");
}

TEST(Config, a_file_that_is_not_toml_is_named_with_its_line) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("bad.toml", "[seam]\nmin_coverage = \n");

  const Outcome outcome = run_program({"config", "--config", file});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find(file + ":2:"), std::string::npos) << outcome.text;
}

TEST(Config, values_that_are_no_numbers_are_out_of_range) {
  const Outcome outcome = run_program({"config", "--set", "seam.min_coverage=nan"});

  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
}

TEST(Config, the_command_line_wins_over_the_file) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("root.toml", "[seam]\nreference = \"root\"\n");

  const Outcome outcome =
      run_program({"config", "--print", "--config", file, "--reference", "gap_middle"});

  EXPECT_NE(outcome.text.find("reference = \"gap_middle\""), std::string::npos) << outcome.text;
}

TEST(Config, the_documentation_lists_every_key_as_it_is) {
  std::ifstream in(DSEAM_DOCS_DIR "/formats.md");
  std::stringstream formats;
  formats << in.rdbuf();

  const Outcome printed = run_program({"config", "--print"});

  EXPECT_NE(formats.str().find("```toml\n" + printed.text + "```"), std::string::npos)
      << "docs/formats.md: replace the toml block by the output of `dseam config --print`";
}

TEST(Usage, what_is_not_understood_exits_with_2) {
  EXPECT_EQ(run_program({}).exit_code, 2);
  EXPECT_EQ(run_program({"frobnicate"}).exit_code, 2);
  EXPECT_EQ(run_program({"extract"}).exit_code, 2);
  EXPECT_EQ(run_program({"config", "--unit", "km"}).exit_code, 2);
}

TEST(Usage, help_and_version_exit_with_0) {
  EXPECT_EQ(run_program({"--help"}).exit_code, 0);
  EXPECT_EQ(run_program({"extract", "--help"}).exit_code, 0);
  EXPECT_EQ(run_program({"--version"}).exit_code, 0);
}

}  // namespace
}  // namespace dseam::program
