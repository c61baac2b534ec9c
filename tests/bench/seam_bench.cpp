// SPDX-License-Identifier: Apache-2.0
// Times the way from a fused cloud to the seam beside what PCL needs for outliers, normals and
// boundary of the same cloud, in turns in one run. Fails where the seam takes more than a tenth.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <vector>

#include "dseam/pipeline/seam_chain.hpp"
#include "pcl_peer.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/joint_cloud.hpp"

namespace dseam::bench {
namespace {

constexpr double kSpacingMm = 0.853;  // About 120,000 points.
constexpr int kRepetitions = 5;
constexpr float kRadiusMm = 2.5F;
constexpr float kGapRad = 1.57079633F;
constexpr float kFarMm = 10000.0F;
// Of a voxel grid that PCL cannot number in 32 bits: it then keeps every point as it is.
constexpr float kNoCellMm = 1e-3F;

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double time_of(const auto& work) {
  const double start = cpu_ms();
  work();
  return cpu_ms() - start;
}

struct Times {
  double seam = 1e300;
  double outliers = 1e300;
  double normals = 1e300;
  double boundary = 1e300;

  [[nodiscard]] double pcl() const { return outliers + normals + boundary; }
};

void keep_least(double& least, double now) { least = std::min(least, now); }

/// The paper's part, seen all round.
test::JointCloudConfig paper_joint() {
  test::JointCloudConfig config;
  config.axis_angle_rad = 62.9 * std::numbers::pi / 180.0;
  config.eccentricity_mm = 1.4;
  config.spacing_mm = kSpacingMm;
  return config;
}

int main_of_bench() {
  const test::JointCloud cloud(paper_joint());
  const cloud::CloudView view = cloud.view().points;
  test::ArenaOwner owner(pipeline::SeamChain::bytes({}));
  pipeline::SeamChain chain = pipeline::SeamChain::make({}, {}, owner.arena()).value();
  std::vector<seam::SeamPoint> storage(4096);
  Buffer<seam::SeamPoint> points{std::span<seam::SeamPoint>(storage)};
  pipeline::SeamInput in;
  in.cloud_base.points = view;
  PclPeer pcl(view.x, view.y, view.z);
  pcl.use_input();
  pcl.passthrough(-kFarMm, kFarMm);
  Times least;
  seam::SeamReport report;
  for (int i = 0; i < kRepetitions; ++i) {
    keep_least(least.seam, time_of([&] { report = chain.run(in, points); }));
    pcl.use_cropped();
    keep_least(least.outliers, time_of([&] { pcl.remove_outliers(5, 1.0); }));
    pcl.use_cleaned();
    pcl.downsample(kNoCellMm);
    pcl.use_cells();
    keep_least(least.normals, time_of([&] { pcl.estimate_normals(kRadiusMm); }));
    keep_least(least.boundary, time_of([&] { pcl.find_boundary(kRadiusMm, kGapRad); }));
  }
  std::printf("%u points, %zu of them after PCL's outliers\n", report.num_points, pcl.num_cells());
  std::printf("dseam: seam %.1f ms (%s, coverage %.3f)\n", least.seam, seam::name(report.refusal),
              report.quality.coverage);
  std::printf("PCL: outliers %.1f + normals %.1f + boundary %.1f = %.1f ms\n", least.outliers,
              least.normals, least.boundary, least.pcl());
  std::printf("%.1f times faster\n", least.pcl() / least.seam);
  return report.weld() && 10.0 * least.seam <= least.pcl() ? 0 : 1;
}

}  // namespace
}  // namespace dseam::bench

int main() { return dseam::bench::main_of_bench(); }
