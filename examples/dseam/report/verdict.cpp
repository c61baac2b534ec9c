// SPDX-License-Identifier: Apache-2.0
#include "report/verdict.hpp"

#include <numbers>

#include "report/text.hpp"

namespace dseam::program {
namespace {

std::string percent(double share) { return fixed(100.0 * share, 1) + " %"; }
std::string degrees(double angle_rad) {
  return fixed(angle_rad * 180.0 / std::numbers::pi, 1) + " degrees";
}

std::string measured(const seam::SeamReport& report) {
  return percent(report.quality.coverage) + " of the seam measured, largest hole " +
         degrees(report.quality.largest_hole_rad);
}

}  // namespace

std::string reason_of(const seam::SeamReport& report, const pipeline::SeamChain::Config& rule) {
  using seam::Refusal;
  switch (report.refusal) {
    case Refusal::kNone:
      return measured(report) + "; sigma " + fixed(report.quality.mean_sigma_lateral_mm, 3) +
             " mm across, " + fixed(report.quality.mean_sigma_normal_mm, 3) + " mm off the shell";
    case Refusal::kEmptyCloud:
      return "the cloud holds no finite point";
    case Refusal::kNotMillimetres:
      return "the whole part is smaller than a nozzle: is the cloud in metres? (--unit m)";
    case Refusal::kCoplanar:
      return "all points lie in one plane: a plate, no nozzle";
    case Refusal::kOneSurface:
      return "only one surface was found; two must meet";
    case Refusal::kNoRing:
      return "no two surfaces meet in a ring with a joint to weld";
    case Refusal::kOutsideRegion:
      return "rings were found, but none in the region or of the radius asked for";
    case Refusal::kTwoRings:
      return "two rings are equally good; the report shows both";
    case Refusal::kLowCoverage:
      return measured(report) + "; at least " + percent(rule.min_coverage) + " are asked for";
    case Refusal::kLargeHole:
      return measured(report) + "; at most " + degrees(rule.max_hole_rad) + " are allowed";
    case Refusal::kNoSuchReference:
      return "the joint does not have the reference curve that was asked for";
    case Refusal::kUncertain:
      return "the seam is known to " + fixed(report.quality.max_sigma_lateral_mm, 3) +
             " mm only; " + fixed(rule.max_sigma_mm, 3) + " mm are asked for";
    case Refusal::kFull:
      return "the workspace is too small for this seam";
    case Refusal::kNoSeam:
      return "no two surfaces meet in an open seam";
    case Refusal::kTwoSeams:
      return "two open seams are equally good; the report shows both";
  }
  return seam::name(report.refusal);
}

namespace {

seam::SeamReport refused_for(seam::Refusal refusal) {
  seam::SeamReport report;
  report.refusal = refusal;
  return report;
}

}  // namespace

std::string paper_reason_of(const pipeline::PaperPipeline::Report& report,
                            const pipeline::PaperPipeline::Config& rule) {
  using seam::Refusal;
  const std::string rim = std::to_string(report.constrained) + " points of the scan's rim";
  switch (report.refusal) {
    case Refusal::kNone:
      return "a closed curve through " + rim + ", " + fixed(report.curve.orthogonal.rms_mm, 3) +
             " mm rms; that it is the seam is for the constraints to ensure";
    case Refusal::kNoRing:
      return rim + " do not make one ring on two surfaces (paper.seam_* draws the constraints)";
    case Refusal::kUncertain:
      return rim + " lie " + fixed(report.curve.orthogonal.rms_mm, 3) +
             " mm rms off any smooth closed curve; at most " + fixed(rule.max_rms_mm, 3) +
             " mm are allowed";
    case Refusal::kLowCoverage:
    case Refusal::kLargeHole:
      return rim + " leave a hole of " + degrees(report.curve.largest_hole_rad);
    default:
      return reason_of(refused_for(report.refusal), {});
  }
}

ExitCode exit_code_of(const seam::SeamReport& report) {
  if (report.weld()) {
    return ExitCode::kDone;
  }
  return seam::is_fault_of_input(report.refusal) ? ExitCode::kInput : ExitCode::kRefused;
}

}  // namespace dseam::program
