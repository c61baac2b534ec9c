// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "config/settings.hpp"
#include "dseam/pipeline/weld_pipeline.hpp"
#include "failure.hpp"
#include "job/lent_memory.hpp"
#include "report/job_report.hpp"
#include "scan/scan.hpp"

namespace dseam::program {

/// The pipeline over a scan, and the memory that it was lent.
class ScanJob {
 public:
  /// Memory for these views and no more.
  ///
  /// Errors:  throws Failure(kUsage) where the configuration contradicts itself, and
  ///          Failure(kInput) for more views or larger ones than a pipeline takes.
  ScanJob(const Settings& settings, const std::vector<ScannedView>& views);

  /// Takes all views in and finds the seam; `job` gets stages, views, cloud, seam and verdict.
  /// Returns what the program should end with.
  ExitCode run(const std::vector<ScannedView>& views, JobReport& job);

 private:
  void describe(const pipeline::WeldReport& report, JobReport& job);

  const Settings& settings_;
  std::unique_ptr<LentMemory> memory_;
  pipeline::WeldPipeline* pipeline_ = nullptr;
};

}  // namespace dseam::program
