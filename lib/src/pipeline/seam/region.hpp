// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "dseam/cloud/cloud.hpp"
#include "dseam/pipeline/seam_chain.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::pipeline {

/// The smallest box around the points of a seam; there must be one.
[[nodiscard]] RegionOfInterest region_around(std::span<const seam::SeamPoint> seam) noexcept;
[[nodiscard]] RegionOfInterest grown(const RegionOfInterest& region, double margin_mm) noexcept;
[[nodiscard]] std::size_t count_inside(const cloud::CloudView& cloud_base,
                                       const RegionOfInterest& region) noexcept;

/// The cell in which a part that fills `num_coarse` coarse cells still fits into `max_cells`:
/// `fine_mm`, or larger for a large part. A surface fills four times the cells at half their size.
[[nodiscard]] double affordable_cell_mm(std::size_t num_coarse, double coarse_mm, double fine_mm,
                                        std::size_t max_cells) noexcept;

}  // namespace dseam::pipeline
