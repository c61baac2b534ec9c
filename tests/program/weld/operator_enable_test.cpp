// SPDX-License-Identifier: Apache-2.0
#include "terminal/operator_enable.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>

namespace dseam::program {
namespace {

/// A terminal whose keys the test presses.
class TerminalEnableTest : public ::testing::Test {
 protected:
  TerminalEnableTest() : screen_(std::tmpfile(), &std::fclose) {
    EXPECT_EQ(::pipe2(keys_.data(), O_CLOEXEC), 0);
    enable_.emplace(keys_[0], screen_.get());
  }
  ~TerminalEnableTest() override {
    enable_.reset();
    ::close(keys_[0]);
    hang_up();
  }

  void press(const char* text) {
    EXPECT_EQ(::write(keys_[1], text, std::strlen(text)), static_cast<ssize_t>(std::strlen(text)));
  }
  void hang_up() {
    if (keys_[1] >= 0) {
      ::close(keys_[1]);
      keys_[1] = -1;
    }
  }
  bool becomes(bool held) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (enable_->held() != held && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return enable_->held() == held;
  }
  /// Until the invitation is on the screen.
  void wait_for_invitation() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::ftell(screen_.get()) == 0 && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> screen_;
  std::array<int, 2> keys_{};
  std::optional<TerminalEnable> enable_;
};

TEST_F(TerminalEnableTest, enter_gives_the_enable_and_enter_once_more_takes_it_back_for_good) {
  enable_->ask();
  wait_for_invitation();

  press("\n");
  EXPECT_TRUE(becomes(true));
  press("\n");
  EXPECT_TRUE(becomes(false));
  press("\n");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(enable_->held());
}

TEST_F(TerminalEnableTest, a_key_pressed_before_the_question_does_not_count) {
  press("\n");
  enable_->ask();
  wait_for_invitation();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));

  EXPECT_FALSE(enable_->held());
}

TEST_F(TerminalEnableTest, a_terminal_that_goes_away_takes_the_enable_with_it) {
  enable_->ask();
  wait_for_invitation();
  press("begin\n");
  EXPECT_TRUE(becomes(true));

  hang_up();

  EXPECT_TRUE(becomes(false));
}

TEST_F(TerminalEnableTest, it_ends_at_once_while_it_waits_for_a_key) {
  enable_->ask();
  wait_for_invitation();
  const auto begin = std::chrono::steady_clock::now();

  enable_.reset();

  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1));
}

}  // namespace
}  // namespace dseam::program
