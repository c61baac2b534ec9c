// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/cloud/crop_box.hpp"
#include "dseam/cloud/normals.hpp"
#include "dseam/cloud/outlier_removal.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "dseam/seam/boundary.hpp"
#include "dseam/seam/curve/closed_curve_fit.hpp"
#include "dseam/seam/seam_report.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::pipeline {

/// The paper's chain in the paper's order, kept to be compared with: passthrough, statistical
/// outliers, voxels, normals, boundary by the largest free angle, coordinate constraints, curve.
///
/// It finds the rim of what was scanned. That is the seam only where the scan has a hole at the
/// joint, and then it lies off by half the hole; a joint that was seen up to its root has no rim.
/// The box of the constraints is drawn by hand, as the paper's was.
///
/// Frame:   that of the cloud.
/// Memory:  `bytes()` from the arena at make(); run() takes none.
/// Time:    linear in the points, but for the neighbours of a point.
/// Context: one thread; not the cycle path.
/// Source:  the paper's equations 2 to 15, k of equation 8 taken from z.
class PaperPipeline {
 public:
  struct Config {
    cloud::OrientedBox passthrough;
    cloud::OutlierRemoval::Config outliers;
    float cell_mm = 3.0F;
    float radius_mm = 7.5F;           ///< Of the neighbours for normals and boundary.
    float min_gap_rad = 1.57079633F;  ///< A larger angle without a neighbour makes a rim.
    cloud::OrientedBox constraints;   ///< The rim's points in it are the seam.
    double point_spacing_mm = 0.5;
    double min_coverage = 0.80;
    double max_rms_mm = 1.0;  ///< Refused when the points lie farther from the curve.
  };
  struct Report {
    cloud::CropBox::Report passthrough;
    cloud::OutlierRemoval::Report outliers;
    cloud::VoxelDownsample::Report voxels;
    cloud::NormalEstimation::Report normals;
    seam::BoundaryTest::Report boundary;
    std::uint32_t constrained = 0;  ///< Points of the rim inside the constraints.
    seam::ClosedCurveFit::Report curve;
    seam::Refusal refusal = seam::Refusal::kEmptyCloud;
  };

  [[nodiscard]] static std::size_t bytes(std::size_t max_points) noexcept;
  /// Errors:  kInvalidArgument: a value of a stage out of range. kOutOfMemory: the arena.
  [[nodiscard]] static Result<PaperPipeline> make(const Config& config, std::size_t max_points,
                                                  Arena& arena) noexcept;

  /// A cloud larger than `max_points` is refused whole (kFull).
  Report run(const cloud::CloudView& cloud, Buffer<seam::SeamPoint>& out) noexcept;

  /// The points that the curve was laid through.
  [[nodiscard]] std::span<const Eigen::Vector3d> rim() const noexcept { return rim_.view(); }

 private:
  struct Stages {
    cloud::CropBox passthrough;
    cloud::OutlierRemoval outliers;
    cloud::VoxelDownsample voxels;
    cloud::NormalEstimation normals;
    seam::BoundaryTest boundary;
    cloud::CropBox constraints;
    search::GridIndex index;
  };

  PaperPipeline(const Config& config, const Stages& stages, std::size_t max_points,
                Arena& arena) noexcept;
  void filter(const cloud::CloudView& cloud, Report& report) noexcept;
  void find_rim(Report& report) noexcept;
  void constrain(Report& report) noexcept;
  [[nodiscard]] seam::Refusal verdict_of(const Report& report) const noexcept;

  Config config_;
  Stages stages_;
  cloud::CloudBuffer points_;
  cloud::CloudBuffer cells_;
  cloud::NormalsBuffer normals_;
  seam::BoundaryBuffer boundary_;
  Buffer<std::uint32_t> kept_;
  Buffer<Eigen::Vector3d> rim_;
  seam::ClosedCurveFit curve_;
};

}  // namespace dseam::pipeline
