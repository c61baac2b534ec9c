// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/buffer.hpp"
#include "dseam/cloud/cloud.hpp"
#include "dseam/seam/joint/joint.hpp"
#include "dseam/seam/surface/surface_finder.hpp"

namespace dseam::seam {

/// Seeks the plane that a nozzle stands on among what lies at its foot alone, and the outside of
/// its wall among the points just above it.
///
/// In a sparse cloud a small plate beside larger steps does not stand out, but a plane that leans
/// through both does; and where a thin wall is seen from both sides, a cylinder between them does.
/// At the foot the outside alone is seen, and the plate is what the wall is seen to end at.
///
/// Memory:  `bytes()` from the arena.
/// Time:    O(kMaxSeen + kTrials * kMaxPieces), kRounds times.
class FootSearch {
 public:
  struct Found {
    Joint joint;
    std::optional<Surface> bore;  ///< The inside of the nozzle's wall, if it was seen.
    double merit = 0.0;           ///< Angles at which wall ends on the plane, less those against.
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return Arena::bytes<Piece>(kMaxPieces) + Arena::bytes<Tile>(kMaxTiles);
  }
  FootSearch() = default;
  explicit FootSearch(Arena& arena) noexcept
      : pieces_(arena.take<Piece>(kMaxPieces)), tiles_(arena.take<Tile>(kMaxTiles)) {}

  /// The nozzle's axis points out of the plane that is sought; the `known` planes compete with
  /// those that are tried. Nothing where no plane lies at the foot.
  std::optional<Found> run(const cloud::CloudView& cloud, std::span<const Cell> cells,
                           const Surface& nozzle, std::span<const FoundSurface> known,
                           const CellScale& scale) noexcept;

 private:
  static constexpr std::size_t kMaxSeen = 32768;
  static constexpr std::size_t kMaxPieces = 8192;
  static constexpr std::size_t kMaxTiles = 1024;
  static constexpr std::size_t kTrials = 2048;
  static constexpr std::size_t kMaxBins = 72;
  struct Piece {  // A point near the nozzle's wall.
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double outside_mm = 0.0;
    std::size_t bin = 0;  // Of the angle about the nozzle.
  };
  struct Tile {  // A cell beside it.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double count = 0.0;
    bool at_foot = false;
    std::size_t bin = 0;
  };
  struct Judged {
    Surface plane;
    double merit = -1e9;
  };
  [[nodiscard]] static bool is_worse(const Judged& a, const Judged& b) noexcept;

  [[nodiscard]] double clear_mm() const noexcept;
  [[nodiscard]] std::size_t bin_of(const NozzleFrame& frame,
                                   const Eigen::Vector3d& p) const noexcept;
  void collect(const cloud::CloudView& cloud, std::span<const Cell> cells) noexcept;
  [[nodiscard]] Judged best_plane(std::span<const FoundSurface> known) const noexcept;
  [[nodiscard]] std::optional<Surface> plane_through(std::size_t trial) const noexcept;
  [[nodiscard]] double merit_of(const Surface& plane) const noexcept;
  [[nodiscard]] Surface refined(Surface plane) const noexcept;
  void fit_circle(const Surface& plane) noexcept;
  void fit_wall(const Surface& plane) noexcept;
  [[nodiscard]] std::optional<Surface> bore_of(const cloud::CloudView& cloud,
                                               const Surface& plane) const noexcept;

  Surface nozzle_;
  CellScale scale_;
  std::size_t num_bins_ = kMaxBins;
  Buffer<Piece> pieces_;
  Buffer<Tile> tiles_;
};

}  // namespace dseam::seam
