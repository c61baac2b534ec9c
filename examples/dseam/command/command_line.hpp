// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "failure.hpp"

namespace dseam::program {

/// Runs the command that the arguments name, with the options that they give it.
///
/// Errors:  Failure with the exit code; what cannot be understood is said here.
ExitCode run_command_line(int argc, char** argv);

/// Each line of the text on the error stream, behind the program's name.
void print_error(const std::string& lines);

}  // namespace dseam::program
