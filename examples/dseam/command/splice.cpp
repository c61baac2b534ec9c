// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "command/commands.hpp"
#include "files/hand_eye_file.hpp"
#include "files/products.hpp"
#include "job/cloud_splice_job.hpp"
#include "job/scan_job.hpp"
#include "scan/replay_scan.hpp"
#include "terminal/interrupt.hpp"

namespace dseam::program {
namespace {

std::size_t num_used(std::span<const splice::SplicedView> views) {
  return static_cast<std::size_t>(std::count_if(
      views.begin(), views.end(),
      [](const splice::SplicedView& view) { return view.state == splice::ViewState::kUsed; }));
}

ExitCode splice_clouds(const SpliceOptions& options, const Invocation& invocation) {
  OutputFolder folder(options.out);
  JobReport job;
  job.command = "splice";
  for (const std::filesystem::path& file : options.inputs) {
    job.input += (job.input.empty() ? "" : ", ") + file.string();
  }
  CloudSpliceJob clouds(options.inputs, invocation.mm_per_unit());
  const std::size_t used = clouds.run(job);
  job.weld = used == options.inputs.size();
  job.reason =
      std::to_string(used) + " of " + std::to_string(options.inputs.size()) + " clouds spliced";
  write_products(job, folder);
  print_summary(job, folder);
  return job.weld ? ExitCode::kDone : ExitCode::kRefused;
}

ExitCode splice_set(const SpliceOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  const std::filesystem::path& set = options.inputs.front();
  std::optional<geometry::RigidTransform> T_flange_camera;
  if (!options.hand_eye.empty()) {
    T_flange_camera = read_hand_eye(options.hand_eye).T_flange_camera;
  }
  OutputFolder folder(options.out);
  const std::atomic<bool>& interrupted = watch_for_interrupt();
  Progress progress;
  ReplayScan source(set);
  const auto views = take_views(source, T_flange_camera, interrupted, progress);

  JobReport job;
  job.command = "splice";
  job.input = set.string();
  ScanJob scan(settings, views);
  (void)scan.run(views, job);  // Whether there is a seam is not the question here.
  const std::size_t used = num_used(job.views);
  job.seam_base = {};
  job.budget.clear();
  job.weld = used == views.size();
  job.reason = std::to_string(used) + " of " + std::to_string(views.size()) + " views spliced";
  write_products(job, folder);
  print_summary(job, folder);
  // One view of several is not spliced to anything.
  return used > 1 || used == views.size() ? ExitCode::kDone : ExitCode::kRefused;
}

}  // namespace

ExitCode run_splice(const SpliceOptions& options, const Invocation& invocation) {
  const bool is_set = std::filesystem::is_directory(options.inputs.front());
  if (is_set && options.inputs.size() > 1) {
    throw Failure(ExitCode::kUsage, "one scan set, or clouds; not both");
  }
  return is_set ? splice_set(options, invocation) : splice_clouds(options, invocation);
}

}  // namespace dseam::program
