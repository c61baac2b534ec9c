// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "command/commands.hpp"
#include "config/load.hpp"

namespace dseam::program {

void add_config(CLI::App& app, Invocation& invocation) {
  auto* command = app.add_subcommand("config", "check a configuration, or print it");
  auto print = std::make_shared<bool>(false);
  command->add_flag("--print", *print, "write every key with its comment, unit and range");
  command->callback([print, &invocation] {
    invocation.run = [print](const Invocation& invoked) {
      Settings settings;
      invoked.configure(settings);
      if (*print) {
        print_config(keys_of(settings), std::cout);
      } else {
        std::cout << "the configuration is valid\n";
      }
      return ExitCode::kDone;
    };
  });
}

}  // namespace dseam::program
