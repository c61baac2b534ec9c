// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "command/commands.hpp"

namespace dseam::program {
namespace {

void add_common_options(CLI::App& app, Invocation& invocation) {
  app.add_option("--config", invocation.config_file, "configuration file (TOML)");
  app.add_option("--set", invocation.assignments, "one key, as section.name=value");
  app.add_option("--unit", invocation.unit, "unit of the clouds read")
      ->check(CLI::IsMember({"mm", "m"}))
      ->capture_default_str();
  app.add_option("--reference", invocation.reference, "which curve of the joint is the seam")
      ->check(CLI::IsMember({"shell_edge", "root", "gap_middle", "nozzle_edge"}));
  app.add_option("--method", invocation.method, "chain of stages")
      ->check(CLI::IsMember({"dseam", "paper"}));
}

/// The paper's chain begins with one merged cloud: elsewhere the option would be without effect.
void check_method(const CLI::App& app, const Invocation& invocation) {
  const std::string command = app.get_subcommands().front()->get_name();
  if (invocation.method == "paper" && command != "extract" && command != "config") {
    throw Failure(
        ExitCode::kUsage,
        "--method paper works on a merged cloud: dseam extract has it, " + command + " does not");
  }
}

void print_error(const std::string& lines) {
  for (std::size_t start = 0; start < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', start), lines.size());
    std::fprintf(stderr, "dseam: %s\n", lines.substr(start, end - start).c_str());
    start = end + 1;
  }
}

ExitCode run(int argc, char** argv) {
  CLI::App app(
      "finds a closed weld seam in the scans of a 3D camera, plans the torch path along "
      "it and streams the path to a robot");
  app.require_subcommand(1);
  app.fallthrough();  // Common options may stand after the command too.
  app.set_version_flag("--version", DSEAM_VERSION);
  Invocation invocation;
  add_common_options(app, invocation);
  add_weld(app, invocation);
  add_extract(app, invocation);
  add_splice(app, invocation);
  add_fit(app, invocation);
  add_calibrate(app, invocation);
  add_record(app, invocation);
  add_robot(app, invocation);
  add_cameras(app, invocation);
  add_link_check(app, invocation);
  add_rt_report(app, invocation);
  add_config(app, invocation);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> unknown = app.remaining(true);
    if (error.get_exit_code() != 0 && !unknown.empty()) {  // Else what is missing hides it.
      print_error("not understood: " + unknown.front());
    }
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kUsage;
  }
  check_method(app, invocation);
  return invocation.run(invocation);
}

}  // namespace
}  // namespace dseam::program

int main(int argc, char** argv) {
  using dseam::program::ExitCode;
  try {
    return static_cast<int>(dseam::program::run(argc, argv));
  } catch (const dseam::program::Failure& failure) {
    dseam::program::print_error(failure.what());
    return static_cast<int>(failure.code());
  } catch (const std::exception& defect) {
    dseam::program::print_error(std::string("a defect of dseam: ") + defect.what());
    return static_cast<int>(ExitCode::kDefect);
  }
}
