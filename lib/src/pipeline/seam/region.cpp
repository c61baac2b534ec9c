// SPDX-License-Identifier: Apache-2.0
#include "pipeline/seam/region.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::pipeline {

RegionOfInterest region_around(std::span<const seam::SeamPoint> seam) noexcept {
  DSEAM_EXPECTS(!seam.empty());
  RegionOfInterest region{seam.front().p_base, seam.front().p_base};
  for (const seam::SeamPoint& point : seam) {
    region.min_base = region.min_base.cwiseMin(point.p_base);
    region.max_base = region.max_base.cwiseMax(point.p_base);
  }
  return region;
}

RegionOfInterest grown(const RegionOfInterest& region, double margin_mm) noexcept {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(margin_mm);
  return {region.min_base - margin, region.max_base + margin};
}

std::size_t count_inside(const cloud::CloudView& cloud_base,
                         const RegionOfInterest& region) noexcept {
  const Eigen::Vector3f low = region.min_base.cast<float>();
  const Eigen::Vector3f high = region.max_base.cast<float>();
  std::size_t inside = 0;
  for (std::size_t i = 0; i < cloud_base.size(); ++i) {
    const bool x = cloud_base.x[i] >= low.x() && cloud_base.x[i] <= high.x();
    const bool y = cloud_base.y[i] >= low.y() && cloud_base.y[i] <= high.y();
    const bool z = cloud_base.z[i] >= low.z() && cloud_base.z[i] <= high.z();
    inside += x && y && z ? 1U : 0U;
  }
  return inside;
}

double affordable_cell_mm(std::size_t num_coarse, double coarse_mm, double fine_mm,
                          std::size_t max_cells) noexcept {
  constexpr double kShareToUse = 0.7;  // A noisy surface touches more cells than a smooth one.
  const double affordable = kShareToUse * static_cast<double>(max_cells);
  const double needed = coarse_mm * std::sqrt(static_cast<double>(num_coarse) / affordable);
  return std::clamp(needed, fine_mm, std::max(fine_mm, coarse_mm));
}

}  // namespace dseam::pipeline
