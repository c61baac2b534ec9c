// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/lanes.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cell_runs.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/search/voxel_hash.hpp"

namespace dseam::cloud {

/// Fuses points into the cubic cells of a lattice: each keeps its centroid, how many points it got
/// and which views they came from.
///
/// Sums are whole numbers of 2^-20 cells, so a centroid does not depend on the order of the points
/// and a million of them lose nothing.
///
/// Frame:   whatever the points are in, usually base.
/// Memory:  about 95 bytes a cell, and 25 kB (3 kB on a microcontroller).
/// Time:    O(1) a point, whatever the coordinates; view() is O(cells).
/// Context: real-time safe; one thread at a time.
/// Source:  the paper's equations 8 (with k from z) and 9.
class VoxelMap {
 public:
  struct Config {
    float cell_mm = 1.0F;
    geometry::Vec3f origin_mm{};  ///< A corner of the lattice.
    std::uint64_t secret = search::VoxelHash::kDefaultSecret;
  };
  struct Report {
    std::uint32_t inserted = 0;
    std::uint32_t dropped_out_of_range = 0;  ///< Not finite, or 2^20 cells from the origin.
    std::uint32_t dropped_full = 0;          ///< Would have needed a cell more than fit.
  };

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept {
    return search::VoxelHash::bytes(max_cells) + Arena::bytes<CellRuns>(1) +
           Arena::bytes<Sum>(max_cells) + CloudBuffer::bytes(max_cells) +
           Arena::bytes<std::uint32_t>(max_cells) + Arena::bytes<ViewMask>(max_cells);
  }
  /// kInvalidArgument: a cell_mm that is not in [1e-3, 1e6], an origin that is not finite, no cell.
  [[nodiscard]] static Result<VoxelMap> make(const Config& config, std::size_t max_cells,
                                             Arena& arena) noexcept;

  void clear() noexcept;
  /// Lays another lattice of the same capacity; also empties the map.
  ///
  /// Errors:  a value that make() refuses is a broken precondition.
  void relay(float cell_mm, geometry::Vec3f origin_mm) noexcept;
  /// `view` is under kMaxViews.
  Report insert(const CloudView& cloud, std::size_t view) noexcept;

  /// The cells in the order in which they were first hit; valid until the map changes.
  [[nodiscard]] FusedCloudView view() noexcept;
  /// The number of the point's cell, VoxelHash::kAbsent when it has none.
  [[nodiscard]] std::uint32_t find(geometry::Vec3f point) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return hash_.size(); }
  [[nodiscard]] std::size_t capacity() const noexcept { return hash_.capacity(); }
  [[nodiscard]] const Config& config() const noexcept { return config_; }

  /// For stages that make points eight at a time: adds those whose bit is set in `valid`. They may
  /// wait until flush(), which must come before another view and before the map is asked.
  [[gnu::always_inline]] void insert_eight(const lanes::FloatLanes& x, const lanes::FloatLanes& y,
                                           const lanes::FloatLanes& z, std::uint32_t valid,
                                           ViewMask seen_by, Report& report) noexcept {
    using lanes::FloatLanes;
    using lanes::splat;
    const FloatLanes per_mm = splat(cells_per_mm_);
    const FloatLanes lx = (x - splat(config_.origin_mm.x)) * per_mm;
    const FloatLanes ly = (y - splat(config_.origin_mm.y)) * per_mm;
    const FloatLanes lz = (z - splat(config_.origin_mm.z)) * per_mm;
    const lanes::IntLanes usable = in_range(lx) & in_range(ly) & in_range(lz);
    const std::uint32_t left = valid & lanes::bits(usable);
    report.dropped_out_of_range += static_cast<std::uint32_t>(std::popcount(valid ^ left));
    if (!runs_[0].has_room()) {
      flush(seen_by, report);
    }
    runs_[0].append(split(lx, usable), split(ly, usable), split(lz, usable), left);
  }
  void flush(ViewMask seen_by, Report& report) noexcept;

 private:
  static constexpr float kMaxAxis = static_cast<float>(search::CellKey::kMaxAxis);
  static constexpr float kStepsPerCell = static_cast<float>(1 << 20);

  /// False for what is not a number.
  [[nodiscard]] static lanes::IntLanes in_range(const lanes::FloatLanes& lattice) noexcept {
    return lanes::magnitude(lattice) < lanes::splat(kMaxAxis);
  }
  /// What is out of range counts as 0 until it is dropped; no other value reaches an integer.
  [[nodiscard]] static CellRuns::Axis split(const lanes::FloatLanes& lattice,
                                            const lanes::IntLanes& in_range) noexcept {
    const lanes::FloatLanes safe = lanes::keep(in_range, lattice);
    const lanes::FloatLanes cell = lanes::floor(safe);
    return {lanes::to_int(cell), lanes::to_int((safe - cell) * lanes::splat(kStepsPerCell))};
  }

  struct Sum {
    std::uint64_t x;
    std::uint64_t y;
    std::uint64_t z;
    std::uint32_t count;
    ViewMask seen_by;
  };

  VoxelMap(const Config& config, const search::VoxelHash& hash, std::size_t max_cells,
           Arena& arena) noexcept;

  Config config_;
  float cells_per_mm_;
  search::VoxelHash hash_;
  std::span<CellRuns> runs_;  ///< One.
  std::span<Sum> sums_;
  CloudBuffer centroids_;
  std::span<std::uint32_t> count_;
  std::span<ViewMask> seen_by_;
};

}  // namespace dseam::cloud
