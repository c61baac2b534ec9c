// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "dseam/cloud/normals.hpp"
#include "dseam/cloud/outlier_removal.hpp"
#include "dseam/cloud/radius_outlier_removal.hpp"
#include "dseam/cloud/voxel_downsample.hpp"
#include "dseam/seam/boundary.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::cloud {

/// FNV-1a over raw bits.
class Digest {
 public:
  template <typename T>
  void add(std::span<const T> values) {
    for (const T& value : values) {
      unsigned char raw[sizeof(T)];
      std::memcpy(raw, &value, sizeof raw);
      for (const unsigned char byte : raw) {
        hash_ = (hash_ ^ byte) * 0x100000001B3ULL;
      }
    }
  }
  void add(const CloudView& cloud) {
    add(cloud.x);
    add(cloud.y);
    add(cloud.z);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

/// All stages over one cloud.
inline std::uint64_t digest_of(const test::OwnedCloud& cloud) {
  const std::size_t n = cloud.size();
  test::ArenaOwner memory(search::GridIndex::bytes(n) + OutlierRemoval::bytes(n) +
                          RadiusOutlierRemoval::bytes(n) + VoxelDownsample::bytes(n) +
                          CloudBuffer::bytes(n) + NormalsBuffer::bytes(n) +
                          seam::BoundaryBuffer::bytes(n) + seam::BoundaryTest::bytes());
  Arena& arena = memory.arena();
  auto index = search::GridIndex::make(n, arena).value();
  std::vector<std::uint32_t> storage(n);
  std::vector<search::Neighbour> rows(n * 6);
  Buffer<std::uint32_t> list(storage);
  CloudBuffer cells(n, arena);
  NormalsBuffer normals(n, arena);
  seam::BoundaryBuffer boundary(n, arena);
  Digest digest;
  index.rebuild(cloud.view());
  index.k_nearest_of_all(6, rows);
  digest.add<search::Neighbour>(rows);
  OutlierRemoval::make({}, n, arena).value().run(index, n, list);
  digest.add(list.view());
  RadiusOutlierRemoval::make({}, n, arena).value().run(index, n, list);
  digest.add(list.view());
  VoxelDownsample::make({.cell_mm = 1.5F}, n, arena).value().run(cloud.view(), cells, list);
  digest.add(cells.view());
  digest.add(list.view());
  index.rebuild(cells.view());
  const geometry::Vec3f sensor{100.0F, 50.0F, 700.0F};
  NormalEstimation::make({.radius_mm = 4.0F})
      .value()
      .run(index, {cells.view(), {}, {}}, {&sensor, 1}, normals);
  const NormalsView view = normals.view(cells.size());
  digest.add(CloudView{view.nx, view.ny, view.nz});
  digest.add(view.variation);
  digest.add(view.state);
  seam::BoundaryTest::make({.radius_mm = 4.0F}, arena).value().run(index, view, boundary, list);
  digest.add(std::span<const float>(boundary.gap_rad.first(cells.size())));
  digest.add(std::span<const float>(boundary.open_x.first(cells.size())));
  digest.add(list.view());
  return digest.value();
}

inline std::uint64_t digest_of_family(test::Family family, std::size_t seeds, std::size_t size) {
  std::uint64_t all = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    all = all * 31 + digest_of(test::make_cloud(family, size + 7 * seed, seed));
  }
  return all;
}

}  // namespace dseam::cloud
