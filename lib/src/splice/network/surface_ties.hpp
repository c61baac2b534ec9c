// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "dseam/cloud/cloud.hpp"
#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/splice/block_system.hpp"
#include "dseam/splice/surface_patches.hpp"
#include "dseam/splice/tie_residuals.hpp"

namespace dseam::splice {

/// The depth bowl's shape at a pixel; times `bowl_mm` it is the error of depth there.
[[nodiscard]] Eigen::Vector2d bowl_shape(const depth::Intrinsics& k, double u, double v) noexcept;

/// A place on a surface as one view measured it.
struct SurfaceSight {
  bool valid = false;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d n_base = Eigen::Vector3d::Zero();
  Eigen::Vector2d bowl_mm_per_mm = Eigen::Vector2d::Zero();  ///< How the bowl lifts p along n.
  double facing = 0.0;  ///< Cosine between the normal and the ray back to the camera.
};

[[nodiscard]] SurfaceSight sight_at(const PosedView& view, double u, double v,
                                    const Eigen::Vector2d& bowl_mm) noexcept;
/// What `view` measured where it sees the place of `other`; not valid when it sees no surface of a
/// similar slope there.
[[nodiscard]] SurfaceSight sight_of(const PosedView& view, const SurfaceSight& other,
                                    const Eigen::Vector2d& bowl_mm) noexcept;

/// How well each view's surface agrees with the others', and how its residuals hang together.
struct SurfaceStatistics {
  std::array<std::uint32_t, cloud::kMaxViews> near{};  ///< Ties within the final gate,
  std::array<std::uint32_t, cloud::kMaxViews> wide{};  ///< and within the wide one.
  std::array<double, cloud::kMaxViews> squares{};      ///< Of the near ones, mm^2.
  std::array<cloud::ViewMask, cloud::kMaxViews> linked{};
  std::array<TieResiduals, kFacings> by_facing{};  ///< By how the reference is seen.

  [[nodiscard]] TieResiduals residuals() const noexcept;  ///< Of all.
  /// How far the errors of each facing's ties spread in sums of many, beside those of all: times
  /// the variance.
  [[nodiscard]] std::array<double, kFacings> spread() const noexcept;
};

constexpr std::array<double, kFacings> kEvenSpread{1.0, 1.0, 1.0, 1.0};

struct SurfaceTieConfig {
  double gate_mm = 8.0;
  double wide_gate_mm = 8.0;
  double weight = 1.0;         ///< One over the variance of a patch, correlation included, 1/mm^2.
  bool without_noise = false;  ///< The information without what noise in normals adds to it.
  std::array<double, kFacings> spread = kEvenSpread;  ///< Times the weight of each facing.
};

/// Adds all surface ties between used views to the system: unknowns 6 v .. 6 v + 5 of view v are
/// its left perturbation about `pivot`, the two at `bowl_at` the bowl's. Returns how many ties.
std::uint32_t add_surface_ties(std::span<const PosedView> views, const Eigen::Vector3d& pivot,
                               const Eigen::Vector2d& bowl_mm, const SurfaceTieConfig& config,
                               std::size_t bowl_at, BlockSystem& system,
                               SurfaceStatistics& statistics) noexcept;

}  // namespace dseam::splice
