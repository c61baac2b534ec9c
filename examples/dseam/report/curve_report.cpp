// SPDX-License-Identifier: Apache-2.0
#include "report/curve_report.hpp"

#include <numbers>

namespace dseam::program {

using seam::ClosedCurveFit;

seam::SeamReport seam_report_of(const ClosedCurveFit::Report& fit) {
  seam::SeamReport report;
  report.refusal = fit.refusal;
  report.closed = fit.refusal == seam::Refusal::kNone;
  report.length_mm = fit.length_mm;
  report.num_points = fit.num_points;
  report.joint.shell = fit.shell;
  report.joint.nozzle = fit.nozzle;
  report.joint.axes_angle_rad = fit.axes_angle_rad;
  report.joint.axes_offset_mm = fit.axes_offset_mm;
  report.quality.largest_hole_rad = fit.largest_hole_rad;
  report.quality.coverage = 1.0 - fit.largest_hole_rad / (2.0 * std::numbers::pi);
  report.quality.lateral = fit.lateral;
  report.quality.normal = fit.normal;
  return report;
}

StageRow curve_row(const ClosedCurveFit::Report& fit, double ms) {
  return {"curve",
          ms,
          {{"points", fit.num_points},
           {"outliers", fit.num_outliers},
           {"coefficients an axis", ClosedCurveFit::kCoefficients},
           {"orthogonal rms mm", fit.orthogonal.rms_mm},
           {"R-squared x", fit.r_squared.x()},
           {"R-squared y", fit.r_squared.y()},
           {"R-squared z", fit.r_squared.z()},
           {"largest hole degrees", fit.largest_hole_rad * 180.0 / std::numbers::pi},
           {"largest hole mm", fit.largest_hole_mm}}};
}

}  // namespace dseam::program
