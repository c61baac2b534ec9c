// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace dseam::program {

/// What the program ends with. docs/formats.md lists which input leads to which.
enum class ExitCode : int {
  kDone = 0,
  kDefect = 1,   ///< A defect of the program itself.
  kUsage = 2,    ///< Usage or configuration.
  kInput = 3,    ///< Unreadable or invalid input.
  kRefused = 4,  ///< The seam was refused for its quality.
  kDevice = 5,   ///< A device or the link failed.
};

/// Ends the command with one clear line that names the file or device and the fault.
class Failure : public std::runtime_error {
 public:
  Failure(ExitCode code, const std::string& line) : std::runtime_error(line), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace dseam::program
