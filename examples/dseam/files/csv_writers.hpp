// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "dseam/seam/seam_curve.hpp"
#include "dseam/trajectory/set_point.hpp"

namespace dseam::program {

/// One standard deviation of a seam point in any one direction across the seam: the root mean
/// square of the lateral and the normal one. report.json has the two apart.
[[nodiscard]] double sigma_mm(const seam::SeamPoint& point) noexcept;
[[nodiscard]] const char* name(seam::Confidence confidence) noexcept;
[[nodiscard]] const char* name(seam::Source source) noexcept;

void write_seam_csv(const seam::SeamView& seam_base, std::ostream& out);
void write_path_csv(trajectory::SetPointView set_points, std::ostream& out);

}  // namespace dseam::program
