// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
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
  double score = 0.0;    ///< The same, and more the closer they all are.
};

/// Finds the planes, spheres, cylinders and cones that explain a cloud's cells, largest first.
///
/// From seeds spread over what is unexplained, a patch gives a first surface of each kind; the
/// surface is refitted while the patch grows, and the kind and seed are kept that explain most, or
/// nearly as much more closely. There is no random number: the same cloud gives the same surfaces.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(attempts * cells), both bounded.
class SurfaceFinder {
 public:
  static constexpr std::size_t kMaxSurfaces = 16;
  static constexpr std::size_t kMaxPatch = 256;

  [[nodiscard]] static constexpr std::size_t bytes(std::size_t max_cells) noexcept {
    return Arena::bytes<bool>(max_cells) + Arena::bytes<std::uint8_t>(max_cells) +
           2 * Arena::bytes<std::uint32_t>(max_cells) + Arena::bytes<Cell>(kMaxPatch) +
           Arena::bytes<FoundSurface>(kMaxSurfaces);
  }
  SurfaceFinder() = default;
  SurfaceFinder(std::size_t max_cells, Arena& arena) noexcept
      : explained_(arena.take<bool>(max_cells)),
        owner_(arena.take<std::uint8_t>(max_cells)),
        open_(arena.take<std::uint32_t>(max_cells)),
        near_(arena.take<std::uint32_t>(max_cells)),
        patch_(arena.take<Cell>(kMaxPatch)),
        surfaces_(arena.take<FoundSurface>(kMaxSurfaces)) {}

  void run(std::span<const Cell> cells, const CellScale& scale) noexcept;
  [[nodiscard]] std::span<const FoundSurface> surfaces() const noexcept { return surfaces_.view(); }

 private:
  void list_open(std::size_t num_cells) noexcept;
  void collect_patch(std::span<const Cell> cells, const Cell& seed, double radius_mm) noexcept;
  FoundSurface best_from(std::span<const Cell> cells, const Cell& seed, double cell_mm) noexcept;
  struct Ball {
    Eigen::Vector3d centre;
    double radius_mm;
    bool far;  // Beyond what lies near the seed.
  };
  FoundSurface best_of_seeds(std::span<const Cell> cells, double cell_mm, double least,
                             double& place) noexcept;
  FoundSurface refitted(std::span<const Cell> cells, const Ball& ball, const Surface& surface,
                        double tolerance_mm) const noexcept;
  FoundSurface grown(std::span<const Cell> cells, const Cell& seed, double patch_mm,
                     Surface surface) const noexcept;
  void keep(const FoundSurface& found) noexcept;
  void compete(std::span<const Cell> cells) noexcept;
  void drop_weaker_than(double least) noexcept;
  void explain(std::span<const Cell> cells, const Surface& surface) noexcept;

  double tolerance_mm_ = 1.0;
  double same_cosine_ = 0.94;
  double explain_cosine_ = 0.85;
  std::span<bool> explained_;
  std::span<std::uint8_t> owner_;
  Buffer<std::uint32_t> open_;  ///< Cells not yet explained.
  Buffer<std::uint32_t> near_;  ///< Those of them near the seed.
  Buffer<Cell> patch_;
  Buffer<FoundSurface> surfaces_;
};

}  // namespace dseam::seam
