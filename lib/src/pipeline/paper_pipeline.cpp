// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/paper_pipeline.hpp"

#include <cmath>
#include <numbers>

namespace dseam::pipeline {

using seam::Refusal;

std::size_t PaperPipeline::bytes(std::size_t max_points) noexcept {
  return search::GridIndex::bytes(max_points) + cloud::OutlierRemoval::bytes(max_points) +
         cloud::VoxelDownsample::bytes(max_points) + seam::BoundaryTest::bytes() +
         2 * cloud::CloudBuffer::bytes(max_points) + cloud::NormalsBuffer::bytes(max_points) +
         seam::BoundaryBuffer::bytes(max_points) + Arena::bytes<std::uint32_t>(max_points) +
         Arena::bytes<Eigen::Vector3d>(max_points) + seam::ClosedCurveFit::bytes(max_points);
}

PaperPipeline::PaperPipeline(const Config& config, const Stages& stages, std::size_t max_points,
                             Arena& arena) noexcept
    : config_(config),
      stages_(stages),
      points_(max_points, arena),
      cells_(max_points, arena),
      normals_(max_points, arena),
      boundary_(max_points, arena),
      kept_(arena.take<std::uint32_t>(max_points)),
      rim_(arena.take<Eigen::Vector3d>(max_points)),
      curve_(max_points, arena) {}

Result<PaperPipeline> PaperPipeline::make(const Config& config, std::size_t max_points,
                                          Arena& arena) noexcept {
  using Voxels = cloud::VoxelDownsample;
  const auto passthrough = cloud::CropBox::make({config.passthrough});
  const auto outliers = cloud::OutlierRemoval::make(config.outliers, max_points, arena);
  const auto voxels = Voxels::make(
      {.cell_mm = config.cell_mm, .lattice = Voxels::Lattice::kMinimumCorner}, max_points, arena);
  const auto normals = cloud::NormalEstimation::make({.radius_mm = config.radius_mm});
  const auto boundary = seam::BoundaryTest::make(
      {.radius_mm = config.radius_mm, .min_gap_rad = config.min_gap_rad}, arena);
  const auto constraints = cloud::CropBox::make({config.constraints});
  const auto index = search::GridIndex::make(max_points, arena);
  if (!passthrough.ok() || !normals.ok() || !constraints.ok() || !(config.point_spacing_mm > 0.0)) {
    return Errc::kInvalidArgument;
  }
  if (!outliers.ok() || !voxels.ok() || !boundary.ok() || !index.ok()) {
    return !outliers.ok()   ? outliers.error()
           : !voxels.ok()   ? voxels.error()
           : !boundary.ok() ? boundary.error()
                            : index.error();
  }
  const Stages stages{passthrough.value(), outliers.value(),    voxels.value(), normals.value(),
                      boundary.value(),    constraints.value(), index.value()};
  const PaperPipeline pipeline(config, stages, max_points, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return pipeline;
}

PaperPipeline::Report PaperPipeline::run(const cloud::CloudView& cloud,
                                         Buffer<seam::SeamPoint>& out) noexcept {
  Report report;
  out.clear();
  if (cloud.size() > points_.capacity()) {
    report.refusal = Refusal::kFull;
    return report;
  }
  filter(cloud, report);
  find_rim(report);
  constrain(report);
  report.curve = curve_.run(rim_.view(), config_.point_spacing_mm, out);
  report.refusal = verdict_of(report);
  return report;
}

void PaperPipeline::filter(const cloud::CloudView& cloud, Report& report) noexcept {
  report.passthrough = stages_.passthrough.run(cloud, kept_);
  points_.clear();
  cloud::copy_kept(cloud, kept_.view(), points_);
  stages_.index.rebuild(points_.view());
  report.outliers = stages_.outliers.run(stages_.index, points_.size(), kept_);
  cloud::copy_kept(points_.view(), kept_.view(), points_);
  report.voxels = stages_.voxels.run(points_.view(), cells_);
}

void PaperPipeline::find_rim(Report& report) noexcept {
  stages_.index.rebuild(cells_.view());
  report.normals = stages_.normals.run(stages_.index, {cells_.view(), {}, {}}, {}, normals_);
  report.boundary =
      stages_.boundary.run(stages_.index, normals_.view(cells_.size()), boundary_, kept_);
}

void PaperPipeline::constrain(Report& report) noexcept {
  points_.clear();
  cloud::copy_kept(cells_.view(), kept_.view(), points_);
  stages_.constraints.run(points_.view(), kept_);
  rim_.clear();
  for (const std::uint32_t i : kept_.view()) {
    const geometry::Vec3f p = points_.view()[i];
    (void)rim_.append(Eigen::Vector3f(p.x, p.y, p.z).cast<double>());
  }
  report.constrained = static_cast<std::uint32_t>(rim_.size());
}

Refusal PaperPipeline::verdict_of(const Report& report) const noexcept {
  if (report.passthrough.kept == 0) {
    return Refusal::kEmptyCloud;
  }
  if (report.curve.refusal != Refusal::kNone) {
    return report.curve.refusal == Refusal::kEmptyCloud ? Refusal::kNoRing : report.curve.refusal;
  }
  const double coverage = 1.0 - report.curve.largest_hole_rad / (2.0 * std::numbers::pi);
  const bool uncertain = !(report.curve.orthogonal.rms_mm <= config_.max_rms_mm);
  return coverage < config_.min_coverage ? Refusal::kLowCoverage
         : uncertain                     ? Refusal::kUncertain
                                         : Refusal::kNone;
}

}  // namespace dseam::pipeline
