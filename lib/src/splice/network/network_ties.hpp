// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "dseam/splice/block_system.hpp"
#include "dseam/splice/view_network.hpp"
#include "splice/network/surface_ties.hpp"

namespace dseam::splice {

struct MarkerStatistics {
  std::array<double, cloud::kMaxViews> squares{};
  std::array<std::uint32_t, cloud::kMaxViews> count{};
  std::array<cloud::ViewMask, cloud::kMaxViews> linked{};
  std::uint32_t landmarks = 0;
  std::uint32_t rejected = 0;
  double chi_squared = 0.0;  ///< Of all sights about their landmarks,
  double freedom = 0.0;      ///< and how large that should be.
};

/// Adds the markers, each landmark's place being eliminated on the spot. `variance_factor` scales
/// the sights' covariances.
void add_marker_ties(std::span<const PosedView> views, std::span<const MarkerSight> sights,
                     const Eigen::Vector3d& pivot, const Eigen::Vector2d& bowl_mm,
                     double variance_factor, std::size_t bowl_at, BlockSystem& system,
                     MarkerStatistics& statistics) noexcept;

/// A pose's difference to the reported one: position in mm, then rotation, and its chi-squared.
struct ReportedResidual {
  geometry::Vector6 value = geometry::Vector6::Zero();
  double chi_squared = 0.0;
};
[[nodiscard]] ReportedResidual reported_residual(const geometry::RigidTransform& T_base_camera,
                                                 const geometry::RigidTransform& reported,
                                                 const ViewNetwork::Config& config) noexcept;

/// Beyond this a reported pose (six degrees of freedom) is wrong, not merely inaccurate.
inline constexpr double kReportedChiSquaredLimit = 40.0;

/// Adds a reported pose; one beyond the limit pulls as little as one that is far away would.
void add_reported_tie(const geometry::RigidTransform& T_base_camera,
                      const geometry::RigidTransform& reported, const Eigen::Vector3d& pivot,
                      const ViewNetwork::Config& config, std::size_t at,
                      BlockSystem& system) noexcept;

}  // namespace dseam::splice
