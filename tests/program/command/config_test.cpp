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

TEST(Config, what_the_gates_would_stop_is_refused_with_the_names_of_both_keys) {
  const struct {
    const char* set;
    const char* key;
    const char* gate;
  } cases[] = {
      {"path.crater_s=1.6", "path.crater_s", "rt.max_standing_s"},
      {"path.ignition_s=1.6", "path.ignition_s", "rt.max_standing_s"},
      {"rt.max_standing_s=0.2", "path.crater_s", "rt.max_standing_s"},
      {"robot.speed_mm_s=600", "robot.speed_mm_s", "rt.max_speed_mm_s"},
      {"robot.acceleration_mm_s2=4000", "robot.acceleration_mm_s2", "rt.max_acceleration_mm_s2"},
      {"robot.jerk_mm_s3=70000", "robot.jerk_mm_s3", "rt.max_jerk_mm_s3"},
      {"robot.angular_speed_rad_s=4", "robot.angular_speed_rad_s", "rt.max_turn_rad_s"},
      {"rt.max_step_mm=2", "robot.period_us", "rt.max_step_mm"},
      {"rt.max_step_rad=0.01", "robot.period_us", "rt.max_step_rad"},
      {"rt.workspace_min_y_mm=4000", "rt.workspace_min_y_mm", "rt.workspace_max_y_mm"},
  };
  for (const auto& c : cases) {
    const Outcome outcome = run_program({"config", "--set", c.set});

    EXPECT_EQ(outcome.exit_code, 2) << c.set;
    EXPECT_NE(outcome.text.find(c.key), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find(c.gate), std::string::npos) << outcome.text;
  }
}

TEST(Config, a_limit_that_is_raised_on_both_sides_is_taken) {
  EXPECT_EQ(
      run_program({"config", "--set", "path.crater_s=3", "--set", "rt.max_standing_s=4"}).exit_code,
      0);
}

TEST(Config, a_word_needs_no_quotes_on_the_command_line) {
  const Outcome outcome = run_program({"config", "--print", "--set", "seam.reference=root"});
  const Outcome bad = run_program({"config", "--print", "--set", "seam.reference=rot"});

  EXPECT_NE(outcome.text.find("reference = \"root\""), std::string::npos) << outcome.text;
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_NE(bad.text.find("'seam.reference' cannot be 'rot'"), std::string::npos) << bad.text;
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

TEST(Usage, a_misspelt_option_is_named_whatever_else_is_missing) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--wrong"}, {"weld", "--wrong", "sim"}, {"config", "--wrong"}}) {
    const Outcome outcome = run_program(words);

    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.text.find("not understood: --wrong"), std::string::npos) << outcome.text;
  }
}

TEST(Usage, help_and_version_exit_with_0) {
  EXPECT_EQ(run_program({"--help"}).exit_code, 0);
  EXPECT_EQ(run_program({"extract", "--help"}).exit_code, 0);
  EXPECT_EQ(run_program({"--version"}).exit_code, 0);
}

}  // namespace
}  // namespace dseam::program
