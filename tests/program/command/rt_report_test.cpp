// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

TEST(RtReportCommand, says_what_the_machine_grants_and_how_late_a_cycle_wakes) {
  const test::Outcome outcome = test::run_program({"rt-report", "--seconds", "0.2"});

  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  for (const char* word : {"kernel", "clock source", "governor", "isolated", "throttling",
                           "memory lock", "scheduling", "processor", "verdict", "wake-up"}) {
    EXPECT_NE(("\n" + outcome.text).find(std::string("\n") + word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace dseam::program
