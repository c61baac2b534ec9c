// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "dseam/seam/curve/coverage.hpp"
#include "dseam/seam/joint/joint_fit.hpp"
#include "dseam/seam/seam_report.hpp"

namespace dseam::seam {

/// What a seam must reach to be welded.
struct QualityLimits {
  double min_coverage = 0.80;
  double max_hole_rad = 1.0471975511965976;  ///< 60 degrees.
  double max_sigma_mm = 0.3;
};

/// High: measured and both sigmas at most 0.1 mm. Medium: measured and at most 0.3 mm, or in a hole
/// of at most 10 degrees and at most 0.1 mm. Low: at most 1 mm. None: the rest.
[[nodiscard]] Confidence confidence_of(const SeamPoint& point, double hole_rad) noexcept;
/// Radii, angle and offset of the axes, and what the fit used.
void describe_joint(const JointFit& fit, JointReport& report) noexcept;
/// Mean and largest gap; false where it is too small to be one.
bool describe_gap(const EdgeCurve& edge, JointReport& report) noexcept;
/// The same of the nozzle's height above the shell.
bool describe_mismatch(const EdgeCurve& edge, JointReport& report) noexcept;
/// Residuals of the points within 6 mm of the joint: those of the shell are normal ones, those of
/// the nozzle lateral.
void describe_residuals(const JointFit& fit, std::span<float> scratch,
                        SeamQuality& quality) noexcept;
/// Mean and largest of the widths that the points have.
void describe_widths(std::span<const SeamPoint> points, JointReport& report) noexcept;
/// Coverage, sigmas and confidences of the finished curve.
void describe_curve(std::span<const SeamPoint> points, SeamReport& report) noexcept;
/// kNone, or the first limit that is not kept.
[[nodiscard]] Refusal verdict_of(const SeamReport& report, const QualityLimits& limits) noexcept;

}  // namespace dseam::seam
