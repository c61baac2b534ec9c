// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "command/commands.hpp"
#include "files/products.hpp"
#include "input/cloud_reader.hpp"
#include "job/extract_job.hpp"
#include "report/verdict.hpp"

namespace dseam::program {
namespace {

void append(const LoadedCloud& part, LoadedCloud& whole) {
  whole.x.insert(whole.x.end(), part.x.begin(), part.x.end());
  whole.y.insert(whole.y.end(), part.y.begin(), part.y.end());
  whole.z.insert(whole.z.end(), part.z.begin(), part.z.end());
  whole.num_not_finite += part.num_not_finite;
}

LoadedCloud read_all(const ExtractOptions& options, double mm_per_unit, std::size_t max_points) {
  LoadedCloud whole;
  for (const std::filesystem::path& file : options.clouds) {
    append(read_cloud(file, mm_per_unit), whole);
    if (whole.size() > max_points) {
      throw Failure(ExitCode::kInput, file.string() + ": " + std::to_string(whole.size()) +
                                          " points so far, the workspace holds " +
                                          std::to_string(max_points) + " (job.max_points)");
    }
  }
  return whole;
}

std::string names_of(const std::vector<std::filesystem::path>& files) {
  std::string names;
  for (const std::filesystem::path& file : files) {
    names += (names.empty() ? "" : ", ") + file.string();
  }
  return names;
}

}  // namespace

ExitCode run_extract(const ExtractOptions& options, const Invocation& invocation) {
  Settings settings;
  invocation.configure(settings);
  OutputFolder folder(options.out);
  Stopwatch watch;
  const LoadedCloud cloud = read_all(options, invocation.mm_per_unit(), settings.max_points);

  JobReport job;
  job.command = "extract";
  job.input = names_of(options.clouds);
  job.stages.push_back({"read",
                        watch.lap_ms(),
                        {{"points", static_cast<double>(cloud.size())},
                         {"not finite", static_cast<double>(cloud.num_not_finite)}}});
  const ExtractJob extraction(settings, cloud, watch, job);
  write_products(job, folder);
  print_summary(job, folder);
  return exit_code_of(job.seam_report);
}

}  // namespace dseam::program
