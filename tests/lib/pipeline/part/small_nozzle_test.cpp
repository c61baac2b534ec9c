// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lib/pipeline/splice/spliced_scan.hpp"
#include "pipeline_run.hpp"
#include "support/accuracy/seam_accuracy.hpp"

namespace dseam::pipeline {
namespace {

// In the first look's cells such a nozzle has too few points round it for a curve.
TEST(SmallNozzle, of_20_mm_on_a_pipe_of_60_is_found_as_well_as_a_large_one) {
  hal::sim::CellConfig config;
  config.joint.shell_radius_mm = 60.0;
  config.joint.nozzle_radius_mm = 20.0;
  config.joint.gap_mm = 1.0;
  config.joint.nozzle_height_mm = 40.0;
  config.views.working_distance_mm = 300.0;
  config.scanner.width = 648;
  config.scanner.height = 483;
  const test::Scan scan = test::scan(config);

  const test::PipelineRun run(scan.frames, scan.reported);

  std::vector<test::ViewPoses> poses;
  for (std::size_t v = 0; v < run.views().size(); ++v) {
    poses.push_back({scan.truth[v], run.views()[v].T_base_camera});
  }
  const auto accuracy =
      test::measure_measured(run.seam(), scan.seam, test::base_correction(poses, scan.seam));
  EXPECT_TRUE(run.report().weld()) << name(run.report().seam.refusal);
  EXPECT_GE(accuracy.coverage, 0.98);
  EXPECT_LT(accuracy.rmse_mm, 0.03);
}

}  // namespace
}  // namespace dseam::pipeline
