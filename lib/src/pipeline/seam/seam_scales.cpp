// SPDX-License-Identifier: Apache-2.0
#include "pipeline/seam/seam_scales.hpp"

#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::pipeline {
namespace {

using seam::Refusal;

constexpr std::size_t kPointsPerCell = 2;  // Fewer on average, and the cells grow instead.
constexpr double kMinExtentMm = 3.0;       // A whole part smaller than this came in metres.
constexpr double kToleranceNoises = 3.0;

}  // namespace

std::size_t num_seam_cells(const SeamChain::Capacity& capacity) noexcept {
  return std::max<std::size_t>(1024, capacity.max_points / kPointsPerCell);
}

Refusal enter_cells(const seam::CellMap::Report& cells, seam::SeamReport& report) noexcept {
  report.num_points = cells.num_points;
  report.num_not_finite = cells.num_not_finite;
  report.noise_mm = cells.noise_mm;
  report.spacing_mm = cells.spacing_mm;
  return cells.num_points == 0            ? Refusal::kEmptyCloud
         : cells.full                     ? Refusal::kFull
         : cells.extent_mm < kMinExtentMm ? Refusal::kNotMillimetres
                                          : Refusal::kNone;
}

double tolerance_mm_of(const seam::CellMap::Report& cells) noexcept {
  return std::max(cells.scale.tolerance_mm(), kToleranceNoises * cells.noise_mm);
}

std::span<const Eigen::Vector3d> all_viewpoints(std::span<const splice::SplicedView> views,
                                                Viewpoints& storage) noexcept {
  const std::size_t count = std::min(views.size(), storage.size());
  for (std::size_t i = 0; i < count; ++i) {
    storage[i] = views[i].T_base_camera.translation_mm;
  }
  return std::span<const Eigen::Vector3d>(storage).first(count);
}

// About half of the views see any one place.
double pose_sigma_of(std::span<const splice::SplicedView> views,
                     const Eigen::Vector3d& p) noexcept {
  double sum = 0.0;
  double count = 0.0;
  for (const splice::SplicedView& view : views) {
    if (view.state == splice::ViewState::kUsed) {
      Eigen::Matrix<double, 3, 6> move;
      move << Eigen::Matrix3d::Identity(), -geometry::skew(p);
      sum += (move * view.covariance * move.transpose()).trace() / 3.0;
      count += 1.0;
    }
  }
  return count > 0.0 ? std::sqrt(sum / count / std::max(1.0, 0.5 * count)) : 0.0;
}

}  // namespace dseam::pipeline
