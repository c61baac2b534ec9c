// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "config/settings.hpp"
#include "dseam/splice/spliced_view.hpp"
#include "input/loaded_cloud.hpp"
#include "report/job_report.hpp"

namespace dseam::program {

/// Clouds in frames of their own, and what splicing makes of them.
///
/// Frame:   the merged cloud and the poses are in the frame of the first cloud.
class CloudSpliceJob {
 public:
  /// Errors:  throws Failure(kInput): a file that is no cloud, more of them than fit.
  CloudSpliceJob(const std::vector<std::filesystem::path>& files, double mm_per_unit);

  /// Fills `job`, whose spans point into this object. Returns how many clouds stand.
  std::size_t run(JobReport& job);

 private:
  void merge();

  std::vector<std::filesystem::path> files_;
  std::vector<LoadedCloud> clouds_;
  std::vector<splice::SplicedView> views_;
  LoadedCloud merged_;
  std::vector<std::uint32_t> count_;
  std::vector<cloud::ViewMask> seen_by_;
};

}  // namespace dseam::program
