// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

TEST(LinkCheck, an_interface_that_is_not_there_is_named) {
  const Outcome outcome = run_program({"link-check", "nosuch0"});

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("nosuch0"), std::string::npos) << outcome.text;
}

TEST(LinkCheck, the_loopback_of_the_internet_is_no_can_interface) {
  const Outcome outcome = run_program({"link-check", "lo"});

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("cannot run on it"), std::string::npos) << outcome.text;
}

TEST(CanRobot, an_interface_that_is_not_there_is_named_before_the_scan_and_nothing_is_written) {
  const test::ScratchFolder scratch;

  const Outcome outcome = run_program(
      {"weld", "--camera", "sim", "--robot", "can:nosuch0", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("nosuch0"), std::string::npos) << outcome.text;
  EXPECT_EQ(outcome.text.find("scanning"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out"), std::set<std::string>{});
}

TEST(CanRobot, without_a_terminal_a_bus_that_is_not_virtual_needs_the_waiver_by_name) {
  const test::ScratchFolder scratch;

  const Outcome outcome =
      run_program({"weld", "--camera", "sim", "--robot", "can:lo", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_NE(outcome.text.find("--waive-operator"), std::string::npos) << outcome.text;
}

TEST(CanRobot, the_reference_robot_names_an_interface_that_is_not_there) {
  const Outcome outcome = run_program({"robot", "--can", "nosuch0"});

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("nosuch0"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace dseam::program
