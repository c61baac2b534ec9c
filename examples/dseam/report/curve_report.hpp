// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/seam/curve/closed_curve_fit.hpp"
#include "report/job_report.hpp"

namespace dseam::program {

/// A closed curve in the terms of a seam report: what the points do not tell stays zero.
[[nodiscard]] seam::SeamReport seam_report_of(const seam::ClosedCurveFit::Report& fit);
/// The curve's line in the table of stages.
[[nodiscard]] StageRow curve_row(const seam::ClosedCurveFit::Report& fit, double ms);

}  // namespace dseam::program
