// SPDX-License-Identifier: Apache-2.0
#include "campaign/seam_row.hpp"

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/cloud/voxel_map.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "support/arena_owner.hpp"

namespace dseam::campaign {
namespace {

using Eigen::Vector3d;
using hal::sim::CellConfig;
using hal::sim::JointKind;
using hal::sim::ShellKind;
using hal::sim::TruthCurve;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMaxCells = 262144;
constexpr double kReachMm = 130.0;  // Of the fused cloud, from the seam's centre.

void nothing(CellConfig&) {}
void touching(CellConfig& c) { c.joint.gap_mm = 0.0; }
void gap_1(CellConfig& c) { c.joint.gap_mm = 1.0; }
void gap_3(CellConfig& c) { c.joint.gap_mm = 3.0; }
void gap_varies(CellConfig& c) {
  c.joint.hole_shift_x_mm = 0.7;
  c.joint.hole_shift_y_mm = -0.5;
}
void set_on(CellConfig& c) {
  c.joint.kind = JointKind::kSetOn;
  c.joint.gap_mm = 0.0;
}
void oval(CellConfig& c) {
  c.joint.nozzle_ovality_mm = 0.3;
  c.joint.shell_ovality_mm = 0.3;
}
void dead_band(CellConfig& c) {
  c.joint.gap_mm = 0.0;
  c.scanner.dead_band_mm = 4.0;
}
void noise_0_1(CellConfig& c) { c.scanner.noise_mm = 0.1; }
void noise_0_3(CellConfig& c) { c.scanner.noise_mm = 0.3; }
void plane(CellConfig& c) { c.joint.shell = ShellKind::kPlane; }
void sphere(CellConfig& c) {
  c.joint.shell = ShellKind::kSphere;
  c.joint.shell_radius_mm = 250.0;
}
void unseen(CellConfig& c) { c.scanner.unseen_share = 0.15; }
void clutter(CellConfig& c) {
  c.clutter.num_clamps = 2;
  c.clutter.second_nozzle_radius_mm = 22.0;
  c.clutter.num_bolt_holes = 4;
  c.clutter.num_spatter = 20;
}
void tacks(CellConfig& c) {
  c.joint.gap_mm = 0.0;
  c.clutter.num_tack_welds = 4;
  c.clutter.num_spatter = 20;
}
void cone(CellConfig& c) { c.joint.nozzle_taper_rad = 4.0 * kDegree; }
void half_seen(CellConfig& c) { c.scanner.unseen_share = 0.5; }
void no_nozzle(CellConfig& c) { c.joint.kind = JointKind::kShellOnly; }

// What differs from seed to seed in every row.
CellConfig drawn(const Row& row, std::uint64_t seed) {
  Pcg32 random(seed, 77);
  CellConfig config;
  config.seed = seed;
  config.joint.axis_angle_rad = (60.0 + 30.0 * random.uniform()) * kDegree;
  config.joint.eccentricity_mm = 40.0 * random.uniform() - 20.0;
  config.joint.nozzle_radius_mm = 45.0 + 20.0 * random.uniform();
  config.joint.nozzle_ovality_angle_rad = 3.0 * random.uniform();
  config.views.first_azimuth_rad = 6.0 * random.uniform();
  config.scanner.unseen_start = random.uniform();
  row.change(config);
  if (config.joint.shell == ShellKind::kPlane) {
    config.joint.eccentricity_mm = 0.0;
  }
  return config;
}

struct Scan {
  std::vector<hal::sim::Rendering> renderings;
  std::vector<depth::DepthImage> frames;
  std::vector<splice::SplicedView> views;
};

Scan scan_of(const hal::sim::Cell& cell) {
  Scan scan;
  scan.renderings.resize(cell.views().size());
  for (std::size_t i = 0; i < cell.views().size(); ++i) {
    cell.scan(i, scan.renderings[i]);
    scan.frames.push_back(hal::sim::image_of(scan.renderings[i], cell.config().scanner));
    splice::SplicedView view;
    view.state = splice::ViewState::kUsed;
    view.T_base_camera = cell.views()[i].T_base_camera;
    scan.views.push_back(view);
  }
  return scan;
}

void fuse_view(const Scan& scan, std::size_t i, const Vector3d& centre, cloud::VoxelMap& map) {
  const depth::DepthImage& frame = scan.frames[i];
  std::vector<float> x, y, z;
  for (std::uint32_t v = 0; v < frame.intrinsics.height; ++v) {
    for (std::uint32_t u = 0; u < frame.intrinsics.width; ++u) {
      const double depth_mm = frame.count_at(u, v) * frame.mm_per_count;
      if (depth_mm == 0.0) {
        continue;
      }
      const Vector3d p_camera((u - frame.intrinsics.cx) * depth_mm / frame.intrinsics.fx,
                              (v - frame.intrinsics.cy) * depth_mm / frame.intrinsics.fy, depth_mm);
      const Vector3d p = scan.views[i].T_base_camera * p_camera;
      if ((p - centre).norm() < kReachMm) {
        x.push_back(static_cast<float>(p.x()));
        y.push_back(static_cast<float>(p.y()));
        z.push_back(static_cast<float>(p.z()));
      }
    }
  }
  (void)map.insert({x, y, z}, i);
}

struct Foot {
  double distance = 1e300;
  Vector3d to_point = Vector3d::Zero();
  std::size_t index = 0;
};

Foot foot_on(const TruthCurve& truth, const Vector3d& p) {
  Foot best;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const Vector3d& a = truth.points[i].p;
    const Vector3d d = truth.points[(i + 1) % truth.points.size()].p - a;
    const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    const Vector3d off = p - a - t * d;
    if (off.norm() < best.distance) {
      best = {off.norm(), off, i};
    }
  }
  return best;
}

double coverage_of(const TruthCurve& truth, std::span<const seam::SeamPoint> points) {
  double covered = 0.0;
  for (const auto& sample : truth.points) {
    bool near = false;
    for (const seam::SeamPoint& point : points) {
      near = near || (point.source == seam::Source::kMeasured &&
                      (point.p_base - sample.p).squaredNorm() <= 1.0);
    }
    covered += near ? 1.0 : 0.0;
  }
  return covered / static_cast<double>(truth.points.size());
}

void judge(const TruthCurve& truth, std::span<const seam::SeamPoint> points, std::uint64_t seed,
           Outcome& out) {
  out.coverage = coverage_of(truth, points);
  const std::size_t drawn = Pcg32(seed, 5).below(static_cast<std::uint32_t>(points.size()));
  double squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const seam::SeamPoint& point = points[i];
    const Foot foot = foot_on(truth, point.p_base);
    const auto& true_point = truth.points[foot.index];
    const Vector3d lateral = true_point.n_shell.cross(true_point.tangent).normalized();
    const double off_lateral = foot.to_point.dot(lateral);
    const double off_normal = foot.to_point.dot(true_point.n_shell);
    out.mean_lateral_mm += off_lateral / static_cast<double>(points.size());
    out.mean_normal_mm += off_normal / static_cast<double>(points.size());
    if (i == drawn) {
      out.nees_lateral = std::pow(off_lateral / point.sigma_lateral_mm, 2);
      out.nees_normal = std::pow(off_normal / point.sigma_normal_mm, 2);
    }
    if (point.source == seam::Source::kMeasured) {
      squares += foot.distance * foot.distance;
      out.num_points += 1.0;
      out.max_mm = std::max(out.max_mm, foot.distance);
    }
  }
  out.rms_mm = std::sqrt(squares / std::max(1.0, out.num_points));
}

}  // namespace

const std::array<Row, 18> kRows = {{
    {"gap 2", nothing, 0.03, 0.08, 0.99},
    {"gap 1", gap_1, 0.03, 0.08, 0.99},
    {"gap 3", gap_3, 0.03, 0.08, 0.99},
    {"gap varies", gap_varies, 0.03, 0.08, 0.99},
    {"touching", touching, 0.03, 0.08, 0.99},
    {"set on", set_on, 0.03, 0.08, 0.99},
    {"oval", oval, 0.06, 0.2, 0.99},
    {"dead band", dead_band, 0.1, 0.3, 0.99},
    {"noise 0.1", noise_0_1, 0.08, 1.0, 0.99},
    {"noise 0.3", noise_0_3, 0.2, 1.0, 0.99},
    {"plane", plane, 0.05, 0.15, 0.99},
    {"sphere", sphere, 0.05, 0.15, 0.99},
    {"unseen 15", unseen, 0.05, 0.15, 0.82},
    {"clutter", clutter, 0.08, 0.5, 0.95},
    {"tacks", tacks, 0.08, 0.5, 0.8},
    {"cone", cone, 0.05, 0.15, 0.99},
    {"half seen", half_seen, 0.0, 0.0, 0.0},
    {"no nozzle", no_nozzle, 0.0, 0.0, 0.0},
}};

Outcome run(const Row& row, std::uint64_t seed) {
  const hal::sim::Cell cell = hal::sim::Cell::make(drawn(row, seed)).value();
  const auto truth = cell.seam();
  const Vector3d centre = cell.config().T_base_part * Vector3d(0.0, 0.0, 0.0);
  const Scan scan = scan_of(cell);
  test::ArenaOwner map_owner(cloud::VoxelMap::bytes(kMaxCells));
  cloud::VoxelMap map =
      cloud::VoxelMap::make({.cell_mm = 1.0F}, kMaxCells, map_owner.arena()).value();
  for (std::size_t i = 0; i < scan.frames.size(); ++i) {
    fuse_view(scan, i, centre, map);
  }
  test::ArenaOwner owner(pipeline::SeamChain::bytes({}));
  pipeline::SeamChain chain = pipeline::SeamChain::make({}, {}, owner.arena()).value();
  std::vector<seam::SeamPoint> storage(4096);
  Buffer<seam::SeamPoint> points{std::span<seam::SeamPoint>(storage)};
  pipeline::SeamInput in;
  in.cloud_base = map.view();
  in.frames = scan.frames;
  in.views = scan.views;
  Outcome out;
  const auto start = std::chrono::steady_clock::now();
  out.report = chain.run(in, points);
  out.milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  out.true_gap_mm = cell.config().joint.gap_mm;
  if (truth && !points.empty()) {
    judge(*truth, points.view(), seed, out);
  }
  return out;
}

}  // namespace dseam::campaign
