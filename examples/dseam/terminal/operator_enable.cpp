// SPDX-License-Identifier: Apache-2.0
#include "terminal/operator_enable.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

namespace dseam::program {
namespace {

constexpr int kLookEveryMs = 50;

bool has_input(int fd, int timeout_ms) {
  pollfd watched{fd, POLLIN, 0};
  return ::poll(&watched, 1, timeout_ms) > 0;
}

}  // namespace

TerminalEnable::TerminalEnable(int input, std::FILE* screen)
    : input_(input), screen_(screen), thread_([this] { listen(); }) {}

TerminalEnable::~TerminalEnable() {
  ended_ = true;
  thread_.join();
}

void TerminalEnable::listen() {
  while (!asked_ && !ended_) {
    std::this_thread::sleep_for(std::chrono::milliseconds(kLookEveryMs));
  }
  if (ended_) {
    return;
  }
  forget_early_lines();
  std::fputs("The robot is ready. Enter begins the weld; Enter once more stops it.\n", screen_);
  std::fflush(screen_);
  held_ = wait_for_line();
  if (held_) {
    (void)wait_for_line();
    held_ = false;
  }
}

void TerminalEnable::forget_early_lines() {
  std::array<char, 256> text{};
  while (has_input(input_, 0) && ::read(input_, text.data(), text.size()) > 0) {
  }
}

bool TerminalEnable::wait_for_line() {
  std::array<char, 256> text{};
  while (!ended_) {
    if (!has_input(input_, kLookEveryMs)) {
      continue;
    }
    const ssize_t size = ::read(input_, text.data(), text.size());
    if (size == 0 || (size < 0 && errno != EINTR && errno != EAGAIN)) {
      return false;
    }
    if (size > 0 && std::memchr(text.data(), '\n', static_cast<std::size_t>(size)) != nullptr) {
      return true;
    }
  }
  return false;
}

}  // namespace dseam::program
