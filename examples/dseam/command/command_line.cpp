// SPDX-License-Identifier: Apache-2.0
// The whole command line on one page, and the only source that parses CLI11's headers.
#include "command/command_line.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <memory>
#include <vector>

#include "command/commands.hpp"

namespace dseam::program {
namespace {

struct Chosen {
  Invocation invocation;
  std::function<ExitCode(const Invocation&)> run;
};

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

/// Once the command is chosen it runs with the options that are returned, which the parser keeps.
template <typename Options>
Options& on(CLI::App& command, ExitCode (*run)(const Options&, const Invocation&), Chosen& chosen) {
  auto options = std::make_shared<Options>();
  command.callback([options, run, &chosen] {
    chosen.run = [options, run](const Invocation& invocation) { return run(*options, invocation); };
  });
  return *options;
}

void add_weld(CLI::App& app, Chosen& chosen) {
  CLI::App& command = *app.add_subcommand("weld", "scan, find the seam, plan the path, weld it");
  WeldOptions& options = on(command, run_weld, chosen);
  command.add_option("--camera", options.camera, "sim, replay:SET, aravis:ID or v4l2:DEV")
      ->required();
  command.add_option("--robot", options.robot, "sim, can:IFACE or none")->capture_default_str();
  command.add_flag("--waive-operator", options.waive_operator,
                   "arm a real robot without an operator's key on this terminal");
  command.add_option("--hand-eye", options.hand_eye, "hand_eye.json of dseam calibrate");
  command.add_option("--truth", options.truth, "folder for the simulated cell's truth");
  command.add_option("--out", options.out, "folder for the results")->required();
}

void add_extract(CLI::App& app, Chosen& chosen) {
  CLI::App& command =
      *app.add_subcommand("extract", "seam of clouds that are already in one frame");
  ExtractOptions& options = on(command, run_extract, chosen);
  command.add_option("cloud", options.clouds, "PLY or PCD files")->required();
  command.add_option("--seam", chosen.invocation.seam, "a ring, or the line between two plates")
      ->check(CLI::IsMember({"closed", "open"}));
  command.add_option("--out", options.out, "folder for the results")->required();
}

void add_splice(CLI::App& app, Chosen& chosen) {
  CLI::App& command =
      *app.add_subcommand("splice", "poses and merged cloud of a scan set, or of clouds");
  SpliceOptions& options = on(command, run_splice, chosen);
  command.add_option("input", options.inputs, "scan set, or PLY and PCD files")->required();
  command.add_option("--hand-eye", options.hand_eye, "hand_eye.json of dseam calibrate");
  command.add_option("--out", options.out, "folder for the results")->required();
}

void add_fit(CLI::App& app, Chosen& chosen) {
  CLI::App& command = *app.add_subcommand("fit", "closed curve through unordered seam points");
  FitOptions& options = on(command, run_fit, chosen);
  command.add_option("points", options.points, "CSV; the first three columns are x, y, z")
      ->required();
  command.add_option("--out", options.out, "folder for the results")->required();
}

void add_calibrate(CLI::App& app, Chosen& chosen) {
  CLI::App& command =
      *app.add_subcommand("calibrate", "where the camera sits on the robot's flange");
  CalibrateOptions& options = on(command, run_calibrate, chosen);
  command
      .add_option("pairs", options.pairs, "pairs of poses (JSON), or a scan set of fixed markers")
      ->required();
  command.add_option("--out", options.out, "folder for hand_eye.json")->required();
}

void add_record(CLI::App& app, Chosen& chosen) {
  CLI::App& command = *app.add_subcommand("record", "write a scan set from any camera");
  RecordOptions& options = on(command, run_record, chosen);
  command.add_option("--camera", options.camera, "sim, replay:SET, aravis:ID or v4l2:DEV")
      ->required();
  command.add_option("--out", options.out, "the new scan set")->required();
}

void add_devices(CLI::App& app, Chosen& chosen) {
  CLI::App& robot =
      *app.add_subcommand("robot", "the reference robot: the other end of the weld link");
  robot.add_option("--can", on(robot, run_robot, chosen).interface, "CAN interface")->required();
  on(*app.add_subcommand("cameras", "list the cameras that can be seen"), run_cameras, chosen);
  CLI::App& check =
      *app.add_subcommand("link-check", "whether a CAN interface will do, and the cure");
  check
      .add_option("interface", on(check, run_link_check, chosen).interface,
                  "CAN interface, as can0")
      ->required();
  CLI::App& report =
      *app.add_subcommand("rt-report", "what this machine gives to real-time threads");
  report
      .add_option("--seconds", on(report, run_rt_report, chosen).seconds,
                  "measure for so long how late a cycle wakes up")
      ->check(CLI::Range(0.0, 1e6));
}

void add_config(CLI::App& app, Chosen& chosen) {
  CLI::App& command = *app.add_subcommand("config", "check a configuration, or print it");
  command.add_flag("--print", on(command, run_config, chosen).print,
                   "write every key with its comment, unit and range");
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

}  // namespace

void print_error(const std::string& lines) {
  for (std::size_t start = 0; start < lines.size();) {
    const std::size_t end = std::min(lines.find('\n', start), lines.size());
    std::fprintf(stderr, "dseam: %s\n", lines.substr(start, end - start).c_str());
    start = end + 1;
  }
}

ExitCode run_command_line(int argc, char** argv) {
  CLI::App app(
      "finds a closed weld seam in the scans of a 3D camera, plans the torch path along "
      "it and streams the path to a robot");
  app.require_subcommand(1);
  app.fallthrough();  // Common options may stand after the command too.
  app.set_version_flag("--version", DSEAM_VERSION);
  Chosen chosen;
  add_common_options(app, chosen.invocation);
  for (const auto add : {add_weld, add_extract, add_splice, add_fit, add_calibrate, add_record,
                         add_devices, add_config}) {
    add(app, chosen);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const std::vector<std::string> unknown = app.remaining(true);
    if (error.get_exit_code() != 0 && !unknown.empty()) {  // Else what is missing hides it.
      print_error("not understood: " + unknown.front());
    }
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kUsage;
  }
  check_method(app, chosen.invocation);
  return chosen.run(chosen.invocation);
}

}  // namespace dseam::program
