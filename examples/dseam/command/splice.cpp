// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include "command/commands.hpp"
#include "files/hand_eye_file.hpp"
#include "job/products.hpp"
#include "job/scan_job.hpp"
#include "scan/replay_scan.hpp"
#include "terminal/interrupt.hpp"

namespace dseam::program {
namespace {

struct Options {
  std::filesystem::path set;
  std::filesystem::path hand_eye;
  std::filesystem::path out;
};

std::size_t num_used(std::span<const splice::SplicedView> views) {
  return static_cast<std::size_t>(std::count_if(
      views.begin(), views.end(),
      [](const splice::SplicedView& view) { return view.state == splice::ViewState::kUsed; }));
}

ExitCode run(const Options& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  if (!std::filesystem::is_directory(options.set)) {
    throw Failure(ExitCode::kInput, options.set.string() + ": no such scan set");
  }
  std::optional<geometry::RigidTransform> T_flange_camera;
  if (!options.hand_eye.empty()) {
    T_flange_camera = read_hand_eye(options.hand_eye).T_flange_camera;
  }
  OutputFolder folder(options.out);
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  Progress progress;
  ReplayScan source(options.set);
  const auto views = take_views(source, T_flange_camera, interrupted, progress);

  JobReport job;
  job.command = "splice";
  job.input = options.set.string();
  ScanJob scan(settings, views);
  (void)scan.run(views, job);  // Whether there is a seam is not the question here.
  const std::size_t used = num_used(job.views);
  job.seam_base = {};
  job.budget.clear();
  job.weld = used == views.size();
  job.reason = std::to_string(used) + " of " + std::to_string(views.size()) + " views spliced";
  write_products(job, folder);
  print_summary(job, folder);
  return used > 0 ? ExitCode::kDone : ExitCode::kRefused;
}

}  // namespace

void add_splice(CLI::App& app, Invocation& invocation) {
  auto* command = app.add_subcommand("splice", "poses and merged cloud of a scan set");
  auto options = std::make_shared<Options>();
  command->add_option("set", options->set, "scan set")->required();
  command->add_option("--hand-eye", options->hand_eye, "hand_eye.json of dseam calibrate");
  command->add_option("--out", options->out, "folder for the results")->required();
  command->callback([options, &invocation] {
    invocation.run = [options](const Invocation& invoked) { return run(*options, invoked); };
  });
}

}  // namespace dseam::program
