// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dseam/cloud/crop_box.hpp"
#include "dseam/cloud/normals.hpp"
#include "dseam/cloud/outlier_removal.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "dseam/seam/boundary.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::bench {

inline constexpr float kLowZ = -1000.0F;
inline constexpr float kHighZ = 250.0F;
inline constexpr float kGapRad = 1.57079633F;

/// The paper's chain, one function a stage; each leaves what the next one needs.
struct CoreChain {
  CoreChain(const test::OwnedCloud& input_cloud, float cell, float radius)
      : input(input_cloud), max_points(input_cloud.size()), cell_mm(cell), radius_mm(radius) {
    crop();
    clean();
    downsample();
    index_cells();
    estimate_normals();
    find_boundary();
  }

  void crop() {
    crop_box.run(input.view(), kept);
    copy_kept(input.view(), kept.view(), cropped);
  }
  void clean() {
    index.rebuild(cropped.view());
    outliers.run(index, cropped.size(), kept);
    copy_kept(cropped.view(), kept.view(), cleaned);
  }
  void downsample() { voxels.run(cleaned.view(), cells); }
  void index_cells() { index.rebuild(cells.view()); }
  void estimate_normals() { normals.run(index, {cells.view(), {}, {}}, {}, normal_buffer); }
  void find_boundary() {
    boundary.run(index, normal_buffer.view(cells.size()), boundary_buffer, found);
  }

  static cloud::OrientedBox box() {
    cloud::OrientedBox box;
    box.low_mm.z = kLowZ;
    box.high_mm.z = kHighZ;
    return box;
  }

  const test::OwnedCloud& input;
  std::size_t max_points;
  float cell_mm;
  float radius_mm;
  test::ArenaOwner memory{
      search::GridIndex::bytes(max_points) + cloud::OutlierRemoval::bytes(max_points) +
      cloud::VoxelDownsample::bytes(max_points) + 3 * cloud::CloudBuffer::bytes(max_points) +
      cloud::NormalsBuffer::bytes(max_points) + seam::BoundaryBuffer::bytes(max_points) +
      seam::BoundaryTest::bytes()};
  search::GridIndex index = search::GridIndex::make(max_points, memory.arena()).value();
  cloud::CropBox crop_box = cloud::CropBox::make({box()}).value();
  cloud::OutlierRemoval outliers =
      cloud::OutlierRemoval::make({}, max_points, memory.arena()).value();
  cloud::VoxelDownsample voxels =
      cloud::VoxelDownsample::make({.cell_mm = cell_mm}, max_points, memory.arena()).value();
  cloud::NormalEstimation normals = cloud::NormalEstimation::make({.radius_mm = radius_mm}).value();
  seam::BoundaryTest boundary =
      seam::BoundaryTest::make({.radius_mm = radius_mm}, memory.arena()).value();
  cloud::CloudBuffer cropped{max_points, memory.arena()};
  cloud::CloudBuffer cleaned{max_points, memory.arena()};
  cloud::CloudBuffer cells{max_points, memory.arena()};
  cloud::NormalsBuffer normal_buffer{max_points, memory.arena()};
  seam::BoundaryBuffer boundary_buffer{max_points, memory.arena()};
  std::vector<std::uint32_t> kept_storage = std::vector<std::uint32_t>(max_points);
  std::vector<std::uint32_t> found_storage = std::vector<std::uint32_t>(max_points);
  Buffer<std::uint32_t> kept{kept_storage};
  Buffer<std::uint32_t> found{found_storage};
};

}  // namespace dseam::bench
