// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "report/job_report.hpp"

namespace dseam::program::test {

/// A finished job on a nozzle (radius 40) standing on a plane shell, with all that a report shows.
class NozzleJob {
 public:
  NozzleJob();
  NozzleJob(const NozzleJob&) = delete;
  NozzleJob& operator=(const NozzleJob&) = delete;

  JobReport job;

 private:
  void add_surfaces();
  void add_seam();
  void add_path();

  std::vector<float> x_, y_, z_;
  std::vector<seam::SeamPoint> seam_;
  std::vector<trajectory::SetPoint> path_;
  std::vector<splice::SplicedView> views_;
};

}  // namespace dseam::program::test
