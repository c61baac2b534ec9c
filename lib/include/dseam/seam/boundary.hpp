// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/base/result.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/search/grid_index.hpp"

namespace dseam::seam {

/// How open the surface is round each point: one entry a point.
///
/// Shape:   `gap_rad` is the largest angle without a neighbour, in [0, 2 pi], 0 where the point has
///          no normal; `open_*` is a unit vector in the tangent plane to the middle of the gap, or
///          0.
struct BoundaryBuffer {
  std::span<float> gap_rad;
  std::span<float> open_x;
  std::span<float> open_y;
  std::span<float> open_z;

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_points) noexcept {
    return 4 * Arena::bytes<float>(max_points);
  }
  BoundaryBuffer() = default;
  BoundaryBuffer(std::size_t max_points, Arena& arena) noexcept
      : gap_rad(arena.take<float>(max_points)),
        open_x(arena.take<float>(max_points)),
        open_y(arena.take<float>(max_points)),
        open_z(arena.take<float>(max_points)) {}
};

struct Gap;

/// Finds the points at the rim of a surface: neighbours projected into the tangent plane leave a
/// large angle free.
///
/// Few angles are compared with one another, many are sorted into kSectors sectors of the turn,
/// each of which keeps its least and its greatest: gaps under 2 pi / kSectors may come out as 0.
///
/// Memory:  30.6 kB.
/// Time:    O(points * neighbours), without a sort.
/// Context: real-time safe; one thread at a time.
/// Source:  the paper's equations 14 and 15, and its screening of the angles.
class BoundaryTest {
 public:
  static constexpr std::size_t kSectors = 64;

  struct Config {
    float radius_mm = 7.5F;
    float min_gap_rad = 1.57079633F;   ///< A larger gap makes a boundary point.
    std::uint32_t min_neighbours = 2;  ///< Others; with fewer it is no boundary point.
  };
  struct Report {
    std::uint32_t boundary = 0;
    std::uint32_t inner = 0;
    std::uint32_t too_few = 0;  ///< Neighbours, so the gap is 0.
    std::uint32_t without_normal = 0;
    std::uint32_t dropped_full = 0;  ///< Boundary points for which `found` had no room.
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<Turns>(lanes::kLanes) + Arena::bytes<Offsets>(1);
  }
  /// kInvalidArgument: a radius or a gap that is not positive and finite.
  /// kOutOfMemory: the arena is too small.
  [[nodiscard]] static Result<BoundaryTest> make(const Config& config, Arena& arena) noexcept;

  /// `index` was built over the cloud of `normals`; `found` gets the boundary points' indices,
  /// rising.
  Report run(const search::GridIndex& index, const cloud::NormalsView& normals, BoundaryBuffer& out,
             Buffer<std::uint32_t>& found) noexcept;

 private:
  static constexpr std::size_t kCapacity = search::NearPoints::kCapacity + lanes::kLanes;
  /// The neighbours of one point, from it.
  struct Offsets {
    float x[kCapacity];
    float y[kCapacity];
    float z[kCapacity];
  };
  /// The angles of many neighbours, sorted into sectors.
  struct Sectors {
    std::uint64_t hit;
    float least[kSectors];
    float greatest[kSectors];

    void clear() noexcept;
    /// Readable to the next multiple of kLanes.
    void add(const float* turns, std::size_t count) noexcept;
    [[nodiscard]] Gap largest_gap() const noexcept;
  };
  /// The angles of one point's neighbours: a list while they are few, as after voxels they are.
  struct Turns {
    static constexpr std::size_t kFew = 5 * lanes::kLanes;

    std::uint32_t num_neighbours;  ///< With those that have no angle; a point finds itself too.
    std::size_t num_listed;
    bool are_many;
    float list[kFew + lanes::kLanes];
    Sectors sectors;

    void clear() noexcept;
    void add(const float* turns, std::size_t count) noexcept;
    [[nodiscard]] Gap largest_gap() noexcept;
  };
  class OfCell;

  BoundaryTest(const Config& config, std::span<Turns> turns, std::span<Offsets> offsets) noexcept
      : config_(config), turns_(turns), offsets_(offsets) {}

  Config config_;
  std::span<Turns> turns_;      ///< Of the eight of a cell.
  std::span<Offsets> offsets_;  ///< One.
};

}  // namespace dseam::seam
