// SPDX-License-Identifier: Apache-2.0
#include "splice_row.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cstdio>
#include <numbers>

#include "dseam/base/random.hpp"
#include "dseam/hal/sim/cell.hpp"
#include "dseam/pipeline/splice_chain.hpp"
#include "support/accuracy/seam_accuracy.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {
namespace {

constexpr SpliceRow kRows[] = {
    {"markers", 18, 0.0, false, 0.03, 0.06}, {"round", 0, 0.0, false, 0.03, 0.10},
    {"oval", 0, 0.3, false, 0.10, 0.25},     {"three", 3, 0.0, true, 0.0, 0.0},
    {"pipes", 0, 0.0, true, 0.03, 0.10},     {"oval-pipes", 0, 0.3, true, 0.10, 0.25}};

hal::sim::CellConfig cell_of(const SpliceRow& row, std::uint64_t seed) {
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
  if (row.without_reports && row.markers > 0) {
    // Side by side: three discs that say little of the far side.
    config.markers.spacing_mm = 10.0;
    config.markers.nearest_mm = 12.0;
    config.markers.farthest_mm = 30.0;
    config.views.azimuth_span_rad = std::numbers::pi / 2.0;
    config.views.count = 3;
  }
  return config;
}

double nees_of(const geometry::Vector6& e, const geometry::Matrix6& covariance) {
  return e.dot(covariance.ldlt().solve(e));
}

// About the seam's centre, so that the numbers stay well conditioned.
geometry::Matrix6 about_centre(const hal::sim::TruthCurve& seam, Eigen::Vector3d& centre) {
  centre.setZero();
  for (const auto& p : seam.points) {
    centre += p.p / static_cast<double>(seam.points.size());
  }
  geometry::Matrix6 here = geometry::Matrix6::Identity();
  here.topRightCorner<3, 3>() = -geometry::skew(centre);
  return here;
}

// Of all views but the last, which the others' mean tells.
void judge_views(const std::vector<geometry::Vector6>& errors, const geometry::Matrix6& here,
                 const splice::JointCovariance& joint, SpliceOutcome& out) {
  const auto n = static_cast<Eigen::Index>(errors.size()) - 1;
  geometry::Vector6 mean = geometry::Vector6::Zero();
  for (const geometry::Vector6& error : errors) {
    mean += error / static_cast<double>(errors.size());
  }
  Eigen::VectorXd e(6 * n);
  Eigen::MatrixXd covariance(6 * n, 6 * n);
  for (Eigen::Index v = 0; v < n; ++v) {
    e.segment<6>(6 * v) = here * (errors[static_cast<std::size_t>(v)] - mean);
    for (Eigen::Index w = 0; w < n; ++w) {
      covariance.block<6, 6>(6 * v, 6 * w) =
          here * joint.at(static_cast<std::size_t>(v), static_cast<std::size_t>(w)) *
          here.transpose();
    }
  }
  out.views_dof = static_cast<int>(6 * n);
  out.views_nees = e.dot(covariance.ldlt().solve(e));
}

SpliceOutcome score(const hal::sim::Cell& cell, std::span<const splice::SplicedView> spliced,
                    const splice::NetworkReport& report, const splice::JointCovariance& joint) {
  SpliceOutcome out;
  out.spliced = report.num_used == cell.views().size();
  if (!out.spliced) {
    return out;
  }
  std::vector<ViewPoses> poses;
  for (std::size_t v = 0; v < spliced.size(); ++v) {
    poses.push_back({cell.views()[v].T_base_camera, spliced[v].T_base_camera});
  }
  const auto seam = *cell.seam();
  out.rms_mm = splice_error(poses, seam).rms_mm;
  const geometry::RigidTransform shift = base_correction(poses, seam).inverse();
  out.has_base = report.has_base;
  Eigen::Vector3d centre;
  const geometry::Matrix6 here = about_centre(seam, centre);
  std::vector<geometry::Vector6> errors;
  for (const ViewPoses& view : poses) {
    errors.push_back(geometry::difference(view.adjusted, shift * view.truth));
  }
  judge_views(errors, here, joint, out);
  out.predicted_mm = splice::predicted_spread_mm(spliced, centre);
  const geometry::Vector6 b = geometry::difference(shift, {});
  out.base_nees = nees_of(here * b, here * report.base_covariance * here.transpose());
  return out;
}

}  // namespace

std::span<const SpliceRow> splice_rows() noexcept { return kRows; }

SpliceOutcome splice_seed(const SpliceRow& row, std::uint64_t seed, std::uint32_t shrink) {
  hal::sim::CellConfig config = cell_of(row, seed);
  config.scanner.width /= shrink;
  config.scanner.height /= shrink;
  const auto cell = hal::sim::Cell::make(config);
  const pipeline::SpliceChain::Capacity capacity{config.scanner.width, config.scanner.height};
  ArenaOwner memory(pipeline::SpliceChain::bytes(capacity));
  auto chain = pipeline::SpliceChain::make({}, capacity, memory.arena());
  hal::sim::Rendering rendering;
  for (std::size_t v = 0; v < config.views.count; ++v) {
    cell.value().scan(v, rendering);
    (void)chain.value().add(hal::sim::image_of(rendering, config.scanner),
                            {!row.without_reports, cell.value().views()[v].T_base_camera_reported});
  }
  std::vector<splice::SplicedView> storage(config.views.count);
  Buffer<splice::SplicedView> spliced(storage);
  const auto report = chain.value().finish(spliced);
  return score(cell.value(), spliced.view(), report, chain.value().joint_covariance());
}

void SpliceTable::add(std::uint64_t seed, const SpliceOutcome& outcome) {
  if (!outcome.spliced) {
    ++refused;
    return;
  }
  rms_mm.push_back(outcome.rms_mm);
  predicted_mm.push_back(outcome.predicted_mm);
  if (outcome.rms_mm > worst_mm) {
    worst_mm = outcome.rms_mm;
    worst_seed = seed;
  }
  views.add(outcome.views_nees, outcome.views_dof);
  if (outcome.has_base) {
    bases.add(outcome.base_nees, 6);
  }
}

void SpliceTable::print(const SpliceRow& row) const {
  if (rms_mm.empty()) {
    std::printf("%-8s no seed spliced, %d refused\n", row.name, refused);
    return;
  }
  std::printf(
      "%-8s %3zu seeds spliced, %d refused: splice error at the seam median %.4f p95 %.4f worst "
      "%.4f mm (seed %llu), predicted median %.4f; NEES inside 95 %%, mean to expected: views "
      "%.1f %%, %.2f; base %.1f %%, %.2f\n",
      row.name, rms_mm.size(), refused, quantile(rms_mm, 0.5), quantile(rms_mm, 0.95), worst_mm,
      static_cast<unsigned long long>(worst_seed), quantile(predicted_mm, 0.5),
      100.0 * views.share_inside(), views.mean_ratio(), 100.0 * bases.share_inside(),
      bases.mean_ratio());
}

bool SpliceTable::holds(const SpliceRow& row) const {
  constexpr std::size_t kSeedsOfQuantile = 200;
  constexpr std::uint32_t kScansOfNees = 300;
  const bool many = rms_mm.size() >= kSeedsOfQuantile;
  const bool asked = row.median_mm > 0.0;
  const bool figures =
      !asked || (refused == 0 && quantile(rms_mm, 0.5) <= row.median_mm &&
                 worst_mm < 2.0 * row.p95_mm && (!many || quantile(rms_mm, 0.95) <= row.p95_mm));
  const bool sigmas = (views.count() < kScansOfNees || views.passes()) &&
                      (bases.count() < kScansOfNees || bases.passes());
  return figures && sigmas;
}

}  // namespace dseam::test
