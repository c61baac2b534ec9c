// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "program/support/run_program.hpp"

namespace dseam::program::test {

/// The built program while it runs, so that a test can interrupt it. Ends it with the test.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments);
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram();

  /// Reads what it writes until `text` stands in it so often; false where it ends before.
  [[nodiscard]] bool writes(const std::string& text, int times = 1);
  void interrupt();
  [[nodiscard]] Outcome wait();
  /// From interrupt() to its end, without the time in which it was ready and others had the
  /// processors: a loaded machine is no fault of the program.
  [[nodiscard]] double seconds_to_end() const { return seconds_to_end_; }

 private:
  [[nodiscard]] bool read_some();
  [[nodiscard]] double seconds_kept_waiting() const;

  pid_t child_ = -1;
  int pipe_ = -1;
  Outcome outcome_;
  double interrupted_s_ = 0.0;
  double kept_waiting_s_ = 0.0;
  double seconds_to_end_ = 0.0;
};

}  // namespace dseam::program::test
