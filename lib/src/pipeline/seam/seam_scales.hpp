// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "dseam/cloud/cloud.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/seam/seam_report.hpp"
#include "dseam/seam/surface/cell_map.hpp"
#include "dseam/splice/spliced_view.hpp"

/// What a seam chain takes from a cloud and its views before it looks for a joint.
namespace dseam::pipeline {

using Viewpoints = std::array<Eigen::Vector3d, cloud::kMaxViews>;

[[nodiscard]] std::size_t num_seam_cells(const SeamChain::Capacity& capacity) noexcept;
/// Enters what the cells tell of the cloud; kNone, or why nothing can be sought in it.
[[nodiscard]] seam::Refusal enter_cells(const seam::CellMap::Report& cells,
                                        seam::SeamReport& report) noexcept;
/// How far cells may lie off their surface.
[[nodiscard]] double tolerance_mm_of(const seam::CellMap::Report& cells) noexcept;
/// `viewpoints[i]` is the place of view `i`, whether it is used or not: bits of a view mask.
[[nodiscard]] std::span<const Eigen::Vector3d> all_viewpoints(
    std::span<const splice::SplicedView> views, Viewpoints& storage) noexcept;
/// How far the fused surface may be displaced at `p` because the views' poses are not exact.
[[nodiscard]] double pose_sigma_of(std::span<const splice::SplicedView> views,
                                   const Eigen::Vector3d& p) noexcept;

}  // namespace dseam::pipeline
