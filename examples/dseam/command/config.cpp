// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "command/commands.hpp"
#include "config/load.hpp"

namespace dseam::program {

ExitCode run_config(const ConfigOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  if (options.print) {
    print_config(keys_of(settings), std::cout);
  } else {
    std::cout << "the configuration is valid\n";
  }
  return ExitCode::kDone;
}

}  // namespace dseam::program
