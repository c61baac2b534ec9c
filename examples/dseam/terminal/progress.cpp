// SPDX-License-Identifier: Apache-2.0
#include "terminal/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace dseam::program {
namespace {

constexpr std::size_t kBarWidth = 30;

}  // namespace

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() { clear_bar(); }

void Progress::show(const std::string& activity, std::size_t done, std::size_t total) {
  const std::size_t tenth = total == 0 ? 10 : std::min<std::size_t>(10, 10 * done / total);
  const bool fresh = activity != activity_;
  activity_ = activity;
  if (terminal_) {
    draw(done, total);
  } else if (fresh || tenth != last_tenth_) {
    std::fprintf(stderr, "%s: %zu of %zu\n", activity.c_str(), done, total);
  }
  last_tenth_ = tenth;
}

void Progress::say(const std::string& line) {
  clear_bar();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Progress::clear_bar() {
  if (drawn_) {
    std::fputs("\r\033[K", stderr);
    drawn_ = false;
  }
}

void Progress::draw(std::size_t done, std::size_t total) {
  const std::size_t filled = total == 0 ? kBarWidth : std::min(kBarWidth, kBarWidth * done / total);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K[%s] %s %zu/%zu", bar.c_str(), activity_.c_str(), done, total);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace dseam::program
