// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/last_gasp.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

namespace {

namespace last_gasp = dseam::rt::last_gasp;

struct Ended {
  int status = 0;
  std::string written;
};

/// Lets a child prepare "first", then "ARC-OFF", and meet its end.
template <typename F>
Ended end_by(F die) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    const std::string first = "first";
    const std::string frame = "ARC-OFF";
    const bool ready = last_gasp::install().ok() &&
                       last_gasp::prepare(ends[1], std::as_bytes(std::span(first))).ok() &&
                       last_gasp::prepare(ends[1], std::as_bytes(std::span(frame))).ok();
    if (ready) {
      die();
    }
    _exit(last_gasp::stop_requested() ? 7 : 8);
  }
  close(ends[1]);
  Ended ended;
  std::array<char, 256> bytes{};
  for (ssize_t got = 0; (got = read(ends[0], bytes.data(), bytes.size())) > 0;) {
    ended.written.append(bytes.data(), static_cast<std::size_t>(got));
  }
  close(ends[0]);
  waitpid(child, &ended.status, 0);
  return ended;
}

TEST(LastGasp, every_signal_of_a_defect_sends_the_frame_and_takes_its_course) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    const Ended ended = end_by([number] { raise(number); });

    EXPECT_EQ(ended.written, "ARC-OFFARC-OFFARC-OFF") << number;
    EXPECT_TRUE(WIFSIGNALED(ended.status)) << number;
    EXPECT_EQ(WTERMSIG(ended.status), number);
  }
}

TEST(LastGasp, abort_and_a_real_segmentation_fault_send_it_too) {
  EXPECT_EQ(end_by([] { std::abort(); }).written, "ARC-OFFARC-OFFARC-OFF");
  EXPECT_EQ(end_by([] {
              volatile int* nowhere = nullptr;
              *nowhere = 1;  // NOLINT: this is the test.
            }).written,
            "ARC-OFFARC-OFFARC-OFF");
}

TEST(LastGasp, a_signal_to_end_sends_it_and_lets_the_program_stop_in_order) {
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) {
    const Ended ended = end_by([number] { raise(number); });

    EXPECT_EQ(ended.written, "ARC-OFFARC-OFFARC-OFF") << number;
    ASSERT_TRUE(WIFEXITED(ended.status)) << number;
    EXPECT_EQ(WEXITSTATUS(ended.status), 7) << number;
  }
}

TEST(LastGasp, who_watched_the_signal_before_is_told_as_well) {
  const Ended ended = end_by([] {
    ::signal(SIGINT, [](int) { _exit(9); });
    (void)last_gasp::install();
    raise(SIGINT);
  });

  EXPECT_EQ(ended.written, "ARC-OFFARC-OFFARC-OFF");
  EXPECT_EQ(WEXITSTATUS(ended.status), 9);
}

TEST(LastGasp, a_second_signal_to_end_is_not_held_up) {
  const Ended ended = end_by([] {
    raise(SIGTERM);
    raise(SIGTERM);
  });

  EXPECT_TRUE(WIFSIGNALED(ended.status));
  EXPECT_EQ(WTERMSIG(ended.status), SIGTERM);
}

TEST(LastGasp, says_nothing_when_nothing_welds) {
  const Ended ended = end_by([] {
    last_gasp::disarm();
    raise(SIGTERM);
  });

  EXPECT_EQ(ended.written, "");
}

TEST(LastGasp, frames_that_cannot_be_are_refused) {
  const std::array<std::byte, last_gasp::kMaxBytes + 1> bytes{};

  EXPECT_FALSE(last_gasp::prepare(-1, std::span(bytes).first(8)).ok());
  EXPECT_FALSE(last_gasp::prepare(1, {}).ok());
  EXPECT_FALSE(last_gasp::prepare(1, bytes).ok());
}

}  // namespace
