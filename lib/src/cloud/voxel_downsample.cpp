// SPDX-License-Identifier: Apache-2.0
#include "dseam/cloud/voxel_downsample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dseam::cloud {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// What is not finite has no corner; a cloud of nothing else gets the origin.
geometry::Vec3f minimum_corner(const CloudView& cloud) noexcept {
  geometry::Vec3f low{kInfinity, kInfinity, kInfinity};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const geometry::Vec3f p = cloud[i];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    }
  }
  return std::isfinite(low.x) ? low : geometry::Vec3f{};
}

}  // namespace

Result<VoxelDownsample> VoxelDownsample::make(const Config& config, std::size_t max_cells,
                                              Arena& arena) noexcept {
  const auto map = VoxelMap::make({config.cell_mm, {}, config.secret}, max_cells, arena);
  if (!map.ok()) {
    return map.error();
  }
  VoxelDownsample stage(config, map.value(), arena.take<Nearest>(max_cells));
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return stage;
}

VoxelDownsample::Report VoxelDownsample::fill(const CloudView& cloud) noexcept {
  if (config_.lattice == Lattice::kMinimumCorner) {
    map_.relay(config_.cell_mm, minimum_corner(cloud));
  } else {
    map_.clear();
  }
  const VoxelMap::Report inserted = map_.insert(cloud, 0);
  return {static_cast<std::uint32_t>(map_.size()), inserted.dropped_out_of_range,
          inserted.dropped_full, 0};
}

void VoxelDownsample::find_nearest(const CloudView& cloud, const CloudView& centroids) noexcept {
  std::fill_n(nearest_.begin(), centroids.size(), Nearest{kInfinity, 0});
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const std::uint32_t cell = map_.find(cloud[i]);
    if (cell == search::VoxelHash::kAbsent) {
      continue;
    }
    const float squared = geometry::squared_norm(cloud[i] - centroids[cell]);
    if (squared < nearest_[cell].squared_mm2) {
      nearest_[cell] = {squared, i};
    }
  }
}

std::uint32_t VoxelDownsample::write_points(const CloudView& cloud, const CloudView& centroids,
                                            CloudBuffer& out) const noexcept {
  const std::size_t count = std::min(centroids.size(), out.capacity());
  out.resize(count);
  if (config_.representative == Representative::kCentroid) {
    std::copy_n(centroids.x.begin(), count, out.x().begin());
    std::copy_n(centroids.y.begin(), count, out.y().begin());
    std::copy_n(centroids.z.begin(), count, out.z().begin());
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      out.set(i, cloud[nearest_[i].index]);
    }
  }
  return static_cast<std::uint32_t>(centroids.size() - count);
}

VoxelDownsample::Report VoxelDownsample::run(const CloudView& cloud, CloudBuffer& out) noexcept {
  Report report = fill(cloud);
  const CloudView centroids = map_.view().points;
  if (config_.representative == Representative::kNearestPoint) {
    find_nearest(cloud, centroids);
  }
  report.cells_cut = write_points(cloud, centroids, out);
  return report;
}

VoxelDownsample::Report VoxelDownsample::run(const CloudView& cloud, CloudBuffer& out,
                                             Buffer<std::uint32_t>& kept) noexcept {
  Report report = fill(cloud);
  const CloudView centroids = map_.view().points;
  find_nearest(cloud, centroids);
  report.cells_cut = write_points(cloud, centroids, out);
  kept.clear();
  for (std::size_t i = 0; i < centroids.size() && kept.append(nearest_[i].index); ++i) {
  }
  const auto unnamed = static_cast<std::uint32_t>(centroids.size() - kept.size());
  report.cells_cut = std::max(report.cells_cut, unnamed);
  return report;
}

}  // namespace dseam::cloud
