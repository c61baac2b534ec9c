// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/linux/rt_report.hpp"

#include <array>
#include <iostream>

#include "command/commands.hpp"
#include "dseam/rt/linux/thread_setup.hpp"

namespace dseam::program {

void add_rt_report(CLI::App& app, Invocation& invocation) {
  auto* command = app.add_subcommand("rt-report", "what this machine gives to real-time threads");
  command->callback([&invocation] {
    invocation.run = [](const Invocation&) {
      const auto granted = rt::set_up_thread({});
      std::array<char, 8192> text{};
      const std::size_t size = rt::format(rt::rt_report(granted.value()), text);
      std::cout.write(text.data(), static_cast<std::streamsize>(size));
      return ExitCode::kDone;
    };
  });
}

}  // namespace dseam::program
