// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace dseam::program::test {

/// What a run of the program left behind.
struct Outcome {
  int exit_code = -1;
  std::string text;  ///< Both streams.
};

/// Runs the built program and waits for it.
[[nodiscard]] Outcome run_program(const std::vector<std::string>& arguments);

/// A folder of one test, empty at its start and gone at its end.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  /// Names of all that lies in a sub-folder; empty where there is none.
  [[nodiscard]] std::set<std::string> names_in(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dseam::program::test
