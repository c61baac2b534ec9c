// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/voxel_map.hpp"

namespace dseam::cloud {

/// Replaces the points of each cubic cell by one.
///
/// Memory:  that of a VoxelMap, 8 bytes a cell.
/// Time:    O(points) whatever the coordinates. Context: real-time safe.
/// Source:  the paper's equations 6 to 9, with k from z in equation 8.
class VoxelDownsample {
 public:
  enum class Lattice : std::uint8_t {
    kOrigin,         ///< A corner of a cell lies at the origin: cells stay where they are.
    kMinimumCorner,  ///< ... at the least coordinates of the cloud, as in the paper.
  };
  enum class Representative : std::uint8_t {
    kCentroid,
    kNearestPoint,  ///< The measured point nearest to the centroid, the paper's fallback.
  };
  struct Config {
    float cell_mm = 3.0F;
    Lattice lattice = Lattice::kOrigin;
    Representative representative = Representative::kCentroid;
    std::uint64_t secret = search::VoxelHash::kDefaultSecret;
  };
  struct Report {
    std::uint32_t cells = 0;
    std::uint32_t dropped_out_of_range =
        0;                           ///< Not finite, or 2^20 cells from the lattice's corner.
    std::uint32_t dropped_full = 0;  ///< Would have needed a cell more than fit.
    std::uint32_t cells_cut = 0;     ///< Cells for which `out` or `kept` had no room.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept {
    return VoxelMap::bytes(max_cells) + Arena::bytes<Nearest>(max_cells);
  }
  /// Errors:  those of VoxelMap::make().
  [[nodiscard]] static Result<VoxelDownsample> make(const Config& config, std::size_t max_cells,
                                                    Arena& arena) noexcept;

  /// Cells in the order in which they were first hit.
  Report run(const CloudView& cloud, CloudBuffer& out) noexcept;
  /// Also the index of the point nearest to each centroid, the first of several.
  Report run(const CloudView& cloud, CloudBuffer& out, Buffer<std::uint32_t>& kept) noexcept;

 private:
  struct Nearest {
    float squared_mm2;
    std::uint32_t index;
  };

  VoxelDownsample(const Config& config, const VoxelMap& map, std::span<Nearest> nearest) noexcept
      : config_(config), map_(map), nearest_(nearest) {}
  Report fill(const CloudView& cloud) noexcept;
  void find_nearest(const CloudView& cloud, const CloudView& centroids) noexcept;
  std::uint32_t write_points(const CloudView& cloud, const CloudView& centroids,
                             CloudBuffer& out) const noexcept;

  Config config_;
  VoxelMap map_;
  std::span<Nearest> nearest_;
};

}  // namespace dseam::cloud
