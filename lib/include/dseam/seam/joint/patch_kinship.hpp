// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dseam::seam {

/// The mean of the points in one patch beside a joint: where it is and how far off the model.
struct Patch {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double phi_rad = 0.0;
  double away = 0.0;  ///< Distance from the joint over the band's width, 0 at the joint.
  double distance_mm = 0.0;
  double weight = 0.0;
  std::size_t place = 0;  ///< In the grid: its row times the patches round, and its column.
};

/// How the patches lie beside a joint: columns round it, rows away from it.
struct PatchGrid {
  std::size_t round = 1;
  double step_round_mm = 1.0;
  double step_away_mm = 1.0;
};

inline constexpr std::size_t kMaxPatches = 512;
inline constexpr std::size_t kPatchesAway = 4;

/// Which patches are compared with their neighbours.
enum class Neighbours : std::uint8_t {
  kRound,      ///< Those round the joint: a deviation hangs together away from it, as noise does.
  kAllAround,  ///< Both: twice as many, so that the number swings less with the noise.
};

/// How many patches tell no more than one, because neighbours err alike.
///
/// Scanners err alike over some distance, in all directions. What the fit took out of the rests is
/// put back.
///
/// Shape:   `rests[i]` is what a fit with `num_columns` unknowns leaves of `patches[i]`.
/// Source:  variance inflation of a mean; correlation falling as exp(-(d / L)^2).
[[nodiscard]] double patches_in_one(std::span<const Patch> patches, std::span<const float> rests,
                                    const PatchGrid& grid, std::size_t num_columns,
                                    Neighbours neighbours) noexcept;

}  // namespace dseam::seam
