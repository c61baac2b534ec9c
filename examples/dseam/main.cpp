// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <string>

#include "command/command_line.hpp"

int main(int argc, char** argv) {
  using dseam::program::ExitCode;
  try {
    return static_cast<int>(dseam::program::run_command_line(argc, argv));
  } catch (const dseam::program::Failure& failure) {
    dseam::program::print_error(failure.what());
    return static_cast<int>(failure.code());
  } catch (const std::exception& defect) {
    dseam::program::print_error(std::string("a defect of dseam: ") + defect.what());
    return static_cast<int>(ExitCode::kDefect);
  }
}
