// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace dseam::program {

/// Says how far long work is: one bar that redraws itself on a terminal, plain lines elsewhere.
class Progress {
 public:
  Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// `done` of `total` parts of `activity`; a plain line only for each new tenth.
  void show(const std::string& activity, std::size_t done, std::size_t total);
  /// A line of its own, above the bar.
  void say(const std::string& line);

 private:
  void clear_bar();
  void draw(std::size_t done, std::size_t total);

  bool terminal_;
  bool drawn_ = false;
  std::string activity_;
  std::size_t last_tenth_ = 0;
};

}  // namespace dseam::program
