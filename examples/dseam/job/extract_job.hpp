// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "config/settings.hpp"
#include "input/loaded_cloud.hpp"
#include "job/lent_memory.hpp"
#include "job/stopwatch.hpp"
#include "report/job_report.hpp"

namespace dseam::program {

/// The seam of one cloud, by the method that is configured, entered into a report.
///
/// Memory:  the report's seam lies in this object, which must outlive it.
class ExtractJob {
 public:
  /// Errors:  throws Failure(kUsage) where the configuration contradicts itself.
  ExtractJob(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch, JobReport& job);

 private:
  template <typename Chain>
  void by_chain(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch,
                JobReport& job);
  void by_paper(const Settings& settings, const LoadedCloud& cloud, Stopwatch& watch,
                JobReport& job);

  std::unique_ptr<LentMemory> memory_;
  std::vector<seam::SeamPoint> points_;
};

}  // namespace dseam::program
