// SPDX-License-Identifier: Apache-2.0
#include "campaign/seam_run.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/weld_pipeline.hpp"
#include "support/accuracy/fused_scan.hpp"
#include "support/accuracy/seam_accuracy.hpp"
#include "support/arena_owner.hpp"
#include "support/gaussian.hpp"

namespace dseam::campaign {
namespace {

using Eigen::Vector3d;
using hal::sim::Cell;
using hal::sim::TruthCurve;

void score(const TruthCurve& truth, std::span<const seam::SeamPoint> points,
           const geometry::RigidTransform& correction, std::uint64_t seed, Outcome& out) {
  const test::SeamAccuracy all = test::measure_seam(points, truth, correction);
  const test::SeamAccuracy measured = test::measure_measured(points, truth, correction);
  out.coverage = measured.coverage;
  out.rms_mm = measured.rmse_mm;
  out.max_mm = measured.max_mm;
  out.num_points = static_cast<double>(measured.points.size());
  for (const test::PointError& error : measured.points) {
    out.mean_lateral_mm += error.lateral_mm / out.num_points;
    out.mean_normal_mm += error.normal_mm / out.num_points;
  }
  const std::size_t drawn = Pcg32(seed, 5).below(static_cast<std::uint32_t>(points.size()));
  const seam::SeamPoint& point = points[drawn];
  out.nees_lateral = std::pow(all.points[drawn].lateral_mm / point.sigma_lateral_mm, 2);
  out.nees_normal = std::pow(all.points[drawn].normal_mm / point.sigma_normal_mm, 2);
}

/// Fuses the views with their true poses and runs the seam chain alone.
void find_with_true_poses(const Cell& cell, const test::TrueScan& scan, std::uint64_t seed,
                          Outcome& out) {
  test::FusedScan fused(cell, scan);
  test::ArenaOwner owner(pipeline::SeamChain::bytes({}));
  pipeline::SeamChain chain = pipeline::SeamChain::make({}, {}, owner.arena()).value();
  std::vector<seam::SeamPoint> storage(4096);
  Buffer<seam::SeamPoint> points{std::span<seam::SeamPoint>(storage)};
  const auto start = std::chrono::steady_clock::now();
  out.report = chain.run(fused.input(), points);
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const auto truth = cell.seam();
  if (truth && !points.empty()) {
    score(*truth, points.view(), {}, seed, out);
  }
}

/// The whole pipeline, from the frames and the poses that the robot reports.
void find_with_spliced_poses(const Cell& cell, const test::TrueScan& scan, std::uint64_t seed,
                             Outcome& out) {
  pipeline::WeldPipeline::Capacity capacity;
  capacity.views.width = cell.config().scanner.width;
  capacity.views.height = cell.config().scanner.height;
  test::ArenaOwner owner(pipeline::WeldPipeline::bytes(capacity));
  auto* pipeline = pipeline::WeldPipeline::make({}, capacity, owner.arena()).value();
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < scan.frames().size(); ++i) {
    (void)pipeline->add(scan.frames()[i], {true, cell.views()[i].T_base_camera_reported}, nullptr);
  }
  out.report = pipeline->finish(nullptr).seam;
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  const auto truth = cell.seam();
  if (!truth || pipeline->seam_points().empty()) {
    return;
  }
  std::vector<test::ViewPoses> poses;
  for (std::size_t i = 0; i < pipeline->views().size(); ++i) {
    if (pipeline->views()[i].state == splice::ViewState::kUsed) {
      poses.push_back({cell.views()[i].T_base_camera, pipeline->views()[i].T_base_camera});
    }
  }
  score(*truth, pipeline->seam_points(), test::base_correction(poses, *truth), seed, out);
}

// A factor for the depth bowl, another one in each row.
double drawn_bowl(const Row& row, std::uint64_t seed) {
  std::uint64_t stream = 0;
  for (const char* c = row.name; *c != '\0'; ++c) {
    stream = 31 * stream + static_cast<unsigned char>(*c);
  }
  Pcg32 random(seed, stream);
  return test::gaussian(random);
}

}  // namespace

Outcome run(const Row& row, std::uint64_t seed, std::uint32_t shrink, Scanner scanner) {
  hal::sim::CellConfig config = cell_of(row, seed);
  config.scanner.bowl_mm *= scanner == Scanner::kDrawn ? drawn_bowl(row, seed) : 1.0;
  config.scanner.width /= shrink;
  config.scanner.height /= shrink;
  const Cell cell = Cell::make(config).value();
  const test::TrueScan scan(cell);
  Outcome out;
  out.true_gap_mm = config.joint.gap_mm;
  if (row.poses == Poses::kTrue) {
    find_with_true_poses(cell, scan, seed, out);
  } else {
    find_with_spliced_poses(cell, scan, seed, out);
  }
  return out;
}

}  // namespace dseam::campaign
