// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>

#include "program/support/run_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::run_program;

std::string ring_of_points(const test::ScratchFolder& scratch) {
  std::string rows = "x,y,z\n";
  for (int i = 0; i < 360; ++i) {
    const double angle = i * 0.0174532925;
    rows += std::to_string(60.0 * std::cos(angle)) + ',' + std::to_string(60.0 * std::sin(angle)) +
            ',' + std::to_string(8.0 * std::cos(2.0 * angle)) + '\n';
  }
  return scratch.write("ring.csv", rows);
}

/// Lets no file of this process, nor of its children, grow beyond a size: what a full disk does to
/// a writer, without one.
class FullDisk {
 public:
  explicit FullDisk(rlim_t max_bytes) {
    (void)::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{max_bytes, before_.rlim_max};
    (void)::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    (void)std::signal(SIGXFSZ, handler_);
    (void)::setrlimit(RLIMIT_FSIZE, &before_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = SIG_DFL;
};

TEST(BadOutput, below_a_file_there_is_no_folder_and_the_work_does_not_begin) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("in_the_way", "");

  const Outcome outcome = run_program({"extract", "x.ply", "--out", file + "/out"});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find(file + "/out: cannot be written"), std::string::npos) << outcome.text;
}

TEST(BadOutput, a_file_is_no_folder_and_stays_as_it_was) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.write("in_the_way", "mine");

  const Outcome outcome = run_program({"fit", ring_of_points(scratch), "--out", file});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find(file + ": cannot be written"), std::string::npos) << outcome.text;
  std::string content;
  std::ifstream(file) >> content;
  EXPECT_EQ(content, "mine");
}

TEST(BadOutput, a_file_system_without_files_is_named_before_the_work) {
  for (const char* folder : {"/proc/self", "/proc/self/out"}) {
    const Outcome outcome = run_program({"extract", "x.ply", "--out", folder});

    EXPECT_EQ(outcome.exit_code, 2) << folder;
    EXPECT_NE(outcome.text.find(std::string(folder) + ": cannot be written"), std::string::npos)
        << outcome.text;
  }
}

TEST(BadOutput, a_full_disk_is_named_and_nothing_stays_whichever_file_it_stops) {
  const test::ScratchFolder scratch;
  const std::string points = ring_of_points(scratch);
  for (const rlim_t max_bytes : {0U, 100U, 5'000U, 100'000U}) {
    const FullDisk full(max_bytes);

    const Outcome outcome = run_program({"fit", points, "--out", scratch.path("out")});

    EXPECT_EQ(outcome.exit_code, 2) << max_bytes << ": " << outcome.text;
    EXPECT_NE(outcome.text.find("cannot be written: File too large"), std::string::npos)
        << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(scratch.path("out"))) << max_bytes;
  }
}

TEST(BadOutput, a_folder_in_the_place_of_one_product_lets_none_of_the_others_through) {
  const test::ScratchFolder scratch;
  std::filesystem::create_directories(scratch.path("out/report.json"));

  const Outcome outcome =
      run_program({"fit", ring_of_points(scratch), "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("report.json: cannot be written"), std::string::npos) << outcome.text;
  EXPECT_EQ(scratch.names_in("out"), std::set<std::string>{"report.json"});
}

TEST(BadOutput, a_set_that_cannot_be_recorded_is_named_and_leaves_nothing) {
  const test::ScratchFolder scratch;
  const FullDisk full(2'000);

  const Outcome outcome = run_program({"record", "--camera", "sim", "--set", "cell.width=160",
                                       "--set", "cell.height=120", "--out", scratch.path("set")});

  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_NE(outcome.text.find(scratch.path("set")), std::string::npos) << outcome.text;
  EXPECT_TRUE(scratch.names_in("set").empty());
}

TEST(BadOutput, a_bus_log_that_does_not_fit_is_named_and_leaves_nothing) {
  const test::ScratchFolder scratch;
  const FullDisk full(200'000);

  const Outcome outcome =
      run_program({"weld", "--camera", "sim", "--robot", "sim", "--set", "cell.width=648", "--set",
                   "cell.height=484", "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_NE(outcome.text.find("can.log: cannot be written"), std::string::npos) << outcome.text;
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
}

}  // namespace
}  // namespace dseam::program
