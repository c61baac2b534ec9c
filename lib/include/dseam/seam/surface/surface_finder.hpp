// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/seam/surface/surface_fit.hpp"

namespace dseam::seam {

/// A surface and how much of the cloud lies on it.
struct FoundSurface {
  Surface surface;
  double support = 0.0;  ///< Cells on it, each weighted by how close it is.
};

/// Finds the planes, spheres, cylinders and cones that explain a cloud's cells, largest first.
///
/// From seeds spread over what is unexplained, a patch gives a first surface of each kind; the
/// surface is refitted while the patch grows, and the kind that explains most is kept. There is
/// no random number: the same cloud gives the same surfaces.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(attempts * cells), both bounded.
class SurfaceFinder {
 public:
  static constexpr std::size_t kMaxSurfaces = 16;
  static constexpr std::size_t kMaxPatch = 256;

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept {
    return Arena::bytes<bool>(max_cells) + Arena::bytes<Cell>(kMaxPatch) +
           Arena::bytes<FoundSurface>(kMaxSurfaces);
  }
  SurfaceFinder() = default;
  SurfaceFinder(std::size_t max_cells, Arena& arena) noexcept
      : explained_(arena.take<bool>(max_cells)),
        patch_(arena.take<Cell>(kMaxPatch)),
        surfaces_(arena.take<FoundSurface>(kMaxSurfaces)) {}

  /// `tolerance_mm`: how far a cell of a surface may lie off it, its ovality included.
  void run(std::span<const Cell> cells, double cell_mm, double tolerance_mm) noexcept;
  [[nodiscard]] std::span<const FoundSurface> surfaces() const noexcept { return surfaces_.view(); }

 private:
  void collect_patch(std::span<const Cell> cells, const Cell& seed, double radius_mm) noexcept;
  FoundSurface best_from(std::span<const Cell> cells, const Cell& seed, double cell_mm) noexcept;
  FoundSurface grown(std::span<const Cell> cells, const Cell& seed, double patch_mm,
                     Surface surface) const noexcept;
  void keep(const FoundSurface& found) noexcept;
  void explain(std::span<const Cell> cells, const Surface& surface) noexcept;

  double tolerance_mm_ = 1.0;
  std::span<bool> explained_;
  Buffer<Cell> patch_;
  Buffer<FoundSurface> surfaces_;
};

}  // namespace dseam::seam
