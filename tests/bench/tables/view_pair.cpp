// SPDX-License-Identifier: Apache-2.0
#include "tables/view_pair.hpp"

#include <algorithm>
#include <ctime>
#include <numbers>

#include "dseam/base/random.hpp"
#include "dseam/cloud/normals.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "dseam/pipeline/splice_chain.hpp"

namespace dseam::bench {
namespace {

using geometry::RigidTransform;

constexpr std::size_t kMaxPoints = 1300000;
constexpr std::size_t kMaxCells = 200000;
constexpr float kCellMm = 2.5F;
constexpr float kNormalRadiusMm = 7.5F;
constexpr double kTableMm = 90.0;  // Behind the part's origin along the ray lies no part.

// Of this process: others on the machine do not count.
double now_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

hal::sim::CellConfig config_of(std::uint64_t seed) {
  hal::sim::CellConfig config;
  config.seed = seed;
  config.markers.count = 0;
  config.joint.axis_angle_rad =
      (60.0 + 10.0 * static_cast<double>(seed % 4)) * std::numbers::pi / 180.0;
  return config;
}

Eigen::Vector3d direction(Pcg32& random) {
  const double x = random.uniform() - 0.5;
  const double y = random.uniform() - 0.5;
  return Eigen::Vector3d(x, y, random.uniform() - 0.5).normalized();
}

}  // namespace

VoxelCloud::VoxelCloud(const depth::DepthImage& image, double farthest_mm)
    : owner_(2 * cloud::CloudBuffer::bytes(kMaxPoints) + cloud::VoxelDownsample::bytes(kMaxCells)) {
  cloud::CloudBuffer all(kMaxPoints, owner_.arena());
  points_ = cloud::CloudBuffer(kMaxCells, owner_.arena());
  const depth::Intrinsics& k = image.intrinsics;
  for (std::uint32_t v = 0; v < k.height; ++v) {
    for (std::uint32_t u = 0; u < k.width; ++u) {
      const double z = image.count_at(u, v) * image.mm_per_count;
      if (z > 0.0 && z < farthest_mm) {
        (void)all.append({static_cast<float>((u - k.cx) / k.fx * z),
                          static_cast<float>((v - k.cy) / k.fy * z), static_cast<float>(z)});
      }
    }
  }
  auto voxels = cloud::VoxelDownsample::make({.cell_mm = kCellMm}, kMaxCells, owner_.arena());
  (void)voxels.value().run(all.view(), points_);
}

ViewPair::ViewPair(std::uint64_t seed) : cell_(hal::sim::Cell::make(config_of(seed)).value()) {
  cell_.scan(0, first_);
  cell_.scan(1, second_);
  target_image_ = hal::sim::image_of(first_, cell_.config().scanner);
  source_image_ = hal::sim::image_of(second_, cell_.config().scanner);
  const double farthest_mm = cell_.config().views.working_distance_mm + kTableMm;
  target_ = std::make_unique<VoxelCloud>(target_image_, farthest_mm);
  source_ = std::make_unique<VoxelCloud>(source_image_, farthest_mm);
  const auto& views = cell_.views();
  const RigidTransform T_target_source = views[0].T_base_camera.inverse() * views[1].T_base_camera;
  const Eigen::Vector3d centre = views[0].T_base_camera.inverse() * cell_.seam()->points[0].p;
  Pcg32 random(seed, 5);
  const Eigen::Matrix3d turn =
      geometry::rotation_exp(direction(random) * 0.5 * std::numbers::pi / 180.0);
  const RigidTransform off{turn, centre - turn * centre + 2.0 * direction(random)};
  start_ = off * T_target_source;
}

ViewPair::Error ViewPair::error_of(const RigidTransform& T_target_source) const {
  const auto& views = cell_.views();
  const RigidTransform T_base_base =
      views[0].T_base_camera * T_target_source * views[1].T_base_camera.inverse();
  Error error;
  const auto truth = *cell_.seam();
  for (const auto& point : truth.points) {
    const Eigen::Vector3d off = T_base_base * point.p - point.p;
    error.rms_mm += off.cwiseAbs2() / static_cast<double>(truth.points.size());
    error.max_mm = std::max(error.max_mm, off.norm());
  }
  error.rms_mm = error.rms_mm.cwiseSqrt();
  return error;
}

Registration by_our_icp(const ViewPair& pair, splice::IcpMetric metric) {
  const bool plane = metric == splice::IcpMetric::kPointToPlane;
  const cloud::CloudView target = pair.target();
  test::ArenaOwner owner(search::GridIndex::bytes(target.size()) +
                         cloud::NormalsBuffer::bytes(target.size()));
  auto index = search::GridIndex::make(target.size(), owner.arena());
  cloud::NormalsBuffer normals(target.size(), owner.arena());
  const auto estimation = cloud::NormalEstimation::make({.radius_mm = kNormalRadiusMm});
  const splice::Icp icp({.metric = metric, .final_gate_mm = 2.0 * double{kCellMm}});
  const double begun = now_ms();
  (void)index.value().rebuild(target);
  cloud::NormalsView view;
  if (plane) {
    (void)estimation.value().run(index.value(), {target, {}, {}}, {}, normals);
    view = normals.view(target.size());
  }
  const auto report = icp.run(pair.source(), target, view, index.value(), pair.start());
  return {plane ? "dseam ICP, to plane" : "dseam ICP, to point", report.T_target_source,
          report.stop != splice::IcpStop::kNoOverlap, now_ms() - begun};
}

Registration by_our_patches(const ViewPair& pair) {
  const pipeline::SpliceChain::Capacity capacity;
  test::ArenaOwner owner(pipeline::SpliceChain::bytes(capacity));
  auto chain = pipeline::SpliceChain::make({}, capacity, owner.arena());
  (void)chain.value().add(pair.target_image(), {true, RigidTransform{}});
  const double begun = now_ms();
  const auto report = chain.value().add(pair.source_image(), {true, pair.start()});
  return {"dseam patches", report.live.T_base_camera,
          report.live.state == splice::LiveSplicer::State::kSpliced, now_ms() - begun};
}

}  // namespace dseam::bench
