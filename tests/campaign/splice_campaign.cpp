// SPDX-License-Identifier: Apache-2.0
// Splices simulated scans and prints the table of splice errors:
//   splice_campaign [ROW [FIRST_SEED [SEEDS]]]
#include <Eigen/Dense>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/splice_chain.hpp"
#include "support/arena_owner.hpp"
#include "support/seam_accuracy.hpp"

namespace dseam::test {
namespace {

struct Row {
  const char* name;
  std::uint32_t markers;
  double ovality_mm;
  bool badly_placed;
};

constexpr Row kRows[] = {{"markers", 18, 0.0, false},
                         {"round", 0, 0.0, false},
                         {"oval", 0, 0.3, false},
                         {"three", 3, 0.0, true}};

hal::sim::CellConfig cell_of(const Row& row, std::uint64_t seed) {
  hal::sim::CellConfig config;
  config.seed = seed;
  Pcg32 random(seed, 77);
  config.joint.axis_angle_rad = (60.0 + 30.0 * random.uniform()) * std::numbers::pi / 180.0;
  config.joint.eccentricity_mm = 20.0 * random.uniform();
  config.joint.shell_radius_mm = 90.0 + 60.0 * random.uniform();
  config.joint.nozzle_radius_mm = 35.0 + 25.0 * random.uniform();
  config.joint.nozzle_ovality_mm = row.ovality_mm;
  config.joint.shell_ovality_mm = row.ovality_mm;
  config.joint.nozzle_ovality_angle_rad = std::numbers::pi * random.uniform();
  config.markers.count = row.markers;
  return config;
}

struct Outcome {
  double rms_mm = 0.0;
  double max_mm = 0.0;
  double predicted_mm = 0.0;
  std::vector<double> view_nees;
  double base_nees = 0.0;
};

double nees_of(const geometry::Vector6& e, const geometry::Matrix6& covariance) {
  return e.dot(covariance.ldlt().solve(e));
}

Outcome judge(const hal::sim::Cell& cell, const Buffer<splice::SplicedView>& spliced,
              const splice::NetworkReport& report) {
  Outcome out;
  std::vector<ViewPoses> poses;
  for (std::size_t v = 0; v < spliced.size(); ++v) {
    poses.push_back({cell.views()[v].T_base_camera, spliced[v].T_base_camera});
  }
  const auto seam = *cell.seam();
  const SpliceError error = splice_error(poses, seam);
  out.rms_mm = error.rms_mm;
  out.max_mm = error.max_mm;
  const geometry::RigidTransform shift = base_correction(poses, seam).inverse();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& p : seam.points) centre += p.p / static_cast<double>(seam.points.size());
  // About the seam's centre, so that the numbers stay well conditioned.
  geometry::Matrix6 here = geometry::Matrix6::Identity();
  here.topRightCorner<3, 3>() = -geometry::skew(centre);
  for (std::size_t v = 0; v < spliced.size(); ++v) {
    const geometry::Vector6 e =
        geometry::difference(spliced[v].T_base_camera, shift * poses[v].truth);
    out.view_nees.push_back(nees_of(here * e, here * spliced[v].covariance * here.transpose()));
  }
  out.predicted_mm = splice::predicted_spread_mm(spliced.view(), centre);
  const geometry::Vector6 b = geometry::difference(shift, {});
  out.base_nees = nees_of(here * b, here * report.base_covariance * here.transpose());
  return out;
}

double now_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

Outcome run_seed(const Row& row, std::uint64_t seed, bool verbose) {
  const hal::sim::CellConfig config = cell_of(row, seed);
  const auto cell = hal::sim::Cell::make(config);
  const std::size_t n = config.views.count;
  pipeline::SpliceChain::Capacity capacity;
  ArenaOwner memory(pipeline::SpliceChain::bytes(capacity));
  auto chain = pipeline::SpliceChain::make({}, capacity, memory.arena());
  hal::sim::Rendering rendering;
  double add_ms = 0.0;
  for (std::size_t v = 0; v < n; ++v) {
    cell.value().scan(v, rendering);
    const double start = now_ms();
    const auto report = chain.value().add(hal::sim::image_of(rendering, config.scanner),
                                          {true, cell.value().views()[v].T_base_camera_reported});
    add_ms += now_ms() - start;
    if (verbose) {
      std::printf(
          "  view %zu: markers %u match %d (%u/%u rms %.3f) patches %u rms %.4f live %d ties %u "
          "share %.2f rms %.3f it %u frozen %u\n",
          v, report.markers.found, int(report.match.state), report.match.num_pairs,
          report.match.num_runner_up, report.match.rms_mm, report.patches.smooth,
          report.patches.median_rms_mm, int(report.live.state), report.live.num_ties,
          report.live.share_near, report.live.rms_mm, report.live.iterations,
          report.live.observability.num_frozen);
    }
  }
  std::vector<splice::SplicedView> storage(n);
  Buffer<splice::SplicedView> spliced(storage);
  const double start = now_ms();
  const auto report = chain.value().finish(spliced);
  const double finish_ms = now_ms() - start;
  Outcome out = judge(cell.value(), spliced, report);
  if (verbose) {
    std::printf(
        "  state %d it %u used %u markers %u rej %u ties %u sigma %.4f tpi %.2f bowl %.4f %.4f add "
        "%.1f ms finish %.1f ms\n",
        int(report.state), report.iterations, report.num_used, report.num_markers,
        report.num_markers_rejected, report.num_surface_ties, report.surface_sigma_mm,
        report.ties_per_independent, report.bowl_mm.x(), report.bowl_mm.y(), add_ms / double(n),
        finish_ms);
    std::printf("  nees");
    for (std::size_t v = 0; v < n; ++v)
      std::printf(" %d:%.1f", int(spliced[v].state), out.view_nees[v]);
    std::printf(" base %.1f\n", out.base_nees);
  }
  return out;
}

int run(const Row& row, std::uint64_t first, std::uint64_t seeds, bool verbose) {
  std::vector<double> rms;
  std::vector<double> predicted;
  double worst = 0.0;
  std::uint64_t worst_seed = 0;
  int in95 = 0;
  int views = 0;
  int base95 = 0;
  double mean_nees = 0.0;
  for (std::uint64_t s = first; s < first + seeds; ++s) {
    const Outcome o = run_seed(row, s, verbose);
    if (verbose)
      std::printf("seed %llu rms %.4f max %.4f predicted %.4f\n",
                  static_cast<unsigned long long>(s), o.rms_mm, o.max_mm, o.predicted_mm);
    rms.push_back(o.rms_mm);
    predicted.push_back(o.predicted_mm);
    if (o.rms_mm > worst) {
      worst = o.rms_mm;
      worst_seed = s;
    }
    for (double x : o.view_nees) {
      in95 += x < 12.592 ? 1 : 0;
      ++views;
      mean_nees += x;
    }
    base95 += o.base_nees < 12.592 ? 1 : 0;
  }
  std::printf(
      "%-8s %4zu seeds: splice error median %.4f p95 %.4f worst %.4f (seed %llu), predicted median "
      "%.4f, views in 95%%: %.1f %% mean NEES %.2f/6, base in 95%%: %.1f %%\n",
      row.name, rms.size(), quantile(rms, 0.5), quantile(rms, 0.95), worst,
      static_cast<unsigned long long>(worst_seed), quantile(predicted, 0.5), 100.0 * in95 / views,
      mean_nees / views, 100.0 * base95 / double(rms.size()));
  return 0;
}

}  // namespace
}  // namespace dseam::test

int main(int argc, char** argv) {
  const std::string wanted = argc > 1 ? argv[1] : "all";
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::uint64_t seeds = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 200;
  for (const auto& row : dseam::test::kRows) {
    if (wanted == "all" || wanted == row.name) {
      dseam::test::run(row, first, seeds, seeds <= 5);
    }
  }
  return 0;
}
