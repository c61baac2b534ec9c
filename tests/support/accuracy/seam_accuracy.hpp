// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/hal/sim/truth.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::test {

/// A view's true pose beside the one that was found for it, both T_base_camera.
struct ViewPoses {
  geometry::RigidTransform truth;
  geometry::RigidTransform adjusted;
};

/// The one rigid transform (adjusted base to true base) that takes the adjusted views to the true
/// ones, by least squares over the places where they put the true seam. No measured point is in it.
[[nodiscard]] geometry::RigidTransform base_correction(std::span<const ViewPoses> views,
                                                       const hal::sim::TruthCurve& truth_base);

/// How far the views put the same true point from each other: the spread about their mean.
struct SpliceError {
  double rms_mm = 0.0;
  double max_mm = 0.0;  ///< The worst place of the seam, rms over the views.
};
[[nodiscard]] SpliceError splice_error(std::span<const ViewPoses> views,
                                       const hal::sim::TruthCurve& truth_base);

/// One seam point's error, split at the foot on the true curve.
struct PointError {
  double distance_mm = 0.0;
  double lateral_mm = 0.0;  ///< Along the shell across the seam, away from the nozzle positive.
  double normal_mm = 0.0;   ///< Along the shell's outward normal.
  double s_mm = 0.0;        ///< Of the foot.
};

/// The accuracy of one seam, by the rule of the design document.
struct SeamAccuracy {
  std::vector<PointError> points;
  double rmse_mm = 0.0;
  double p95_mm = 0.0;
  double max_mm = 0.0;
  double coverage = 0.0;  ///< Share of the true length with a measured row within 1 mm.
};

/// `correction` is base_correction() of the same run, or the identity where true poses were given.
[[nodiscard]] SeamAccuracy measure_seam(std::span<const seam::SeamPoint> points,
                                        const hal::sim::TruthCurve& truth_base,
                                        const geometry::RigidTransform& correction);
/// As measure_seam(), over the rows whose source is measured only.
[[nodiscard]] SeamAccuracy measure_measured(std::span<const seam::SeamPoint> points,
                                            const hal::sim::TruthCurve& truth_base,
                                            const geometry::RigidTransform& correction);

/// Root mean square of the errors of several runs together, each point with the same weight.
[[nodiscard]] double pooled_rmse_mm(std::span<const SeamAccuracy> runs);
/// The value that `share` of the values do not exceed, linearly interpolated; 0 for none.
[[nodiscard]] double quantile(std::vector<double> values, double share);

}  // namespace dseam::test
