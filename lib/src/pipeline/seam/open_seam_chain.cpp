// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/open_seam_chain.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/seam/curve/quality.hpp"
#include "pipeline/seam/seam_scales.hpp"

namespace dseam::pipeline {
namespace {

using seam::OpenCandidate;
using seam::Refusal;
using seam::RingFate;

constexpr double kEqualShare = 0.75;  // Of the best one's score: no choice to be made.
constexpr double kSameSeamMm = 4.0;   // Two fits of one wall; the two faces of a plate are farther.
constexpr double kSlitStepMm = 2.0;

seam::RingCandidate shown(const OpenCandidate& found) noexcept {
  seam::RingCandidate candidate;
  candidate.centre_base = found.centre;
  candidate.axis_base = found.joint.normal(0, found.centre);
  candidate.coverage = found.coverage;
  candidate.score_mm = found.score_mm;
  candidate.fate = found.fate;
  candidate.shell = found.joint.surface[0].kind;
  candidate.nozzle = found.joint.surface[1].kind;
  return candidate;
}

bool is_valid(const OpenSeamChain::Config& c) noexcept {
  const auto at_least_0 = [](double v) { return v >= 0.0 && std::isfinite(v); };
  return at_least_0(c.min_coverage) && c.min_coverage <= 1.0 && at_least_0(c.max_hole_rad) &&
         c.max_sigma_mm > 0.0 && c.point_spacing_mm > 0.0 && std::isfinite(c.point_spacing_mm) &&
         at_least_0(c.hand_eye_sigma_mm) && at_least_0(c.scanner_sigma_mm);
}

bool is_better(const OpenCandidate& a, const OpenCandidate& b) noexcept {
  return a.score_mm > b.score_mm;
}

}  // namespace

std::size_t OpenSeamChain::bytes(const Capacity& capacity) noexcept {
  const std::size_t cells = num_seam_cells(capacity);
  return seam::CellMap::bytes(cells) + seam::SurfaceFinder::bytes(cells) +
         seam::FilletFinder::bytes() + seam::SlitFinder::bytes() +
         Arena::bytes<OpenCandidate>(kMaxFound) + seam::SeamTrack::bytes() +
         Arena::bytes<seam::OpenSides>(1) + seam::OpenSides::bytes(capacity.max_points);
}

OpenSeamChain::OpenSeamChain(const Config& config, const Capacity& capacity, Arena& arena) noexcept
    : config_(config),
      cells_(num_seam_cells(capacity), arena),
      surfaces_(num_seam_cells(capacity), arena),
      fillets_(arena),
      slits_(arena),
      found_(arena.take<OpenCandidate>(kMaxFound)),
      track_(arena),
      sides_(arena.take<seam::OpenSides>(1)) {
  if (!sides_.empty()) {
    sides_[0] = seam::OpenSides(capacity.max_points, arena);
  }
}

Result<OpenSeamChain> OpenSeamChain::make(const Config& config, const Capacity& capacity,
                                          Arena& arena) noexcept {
  if (!is_valid(config) || capacity.max_points < 64) {
    return Errc::kInvalidArgument;
  }
  const OpenSeamChain chain(config, capacity, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return chain;
}

seam::SeamReport OpenSeamChain::run(const SeamInput& in, Buffer<seam::SeamPoint>& out) noexcept {
  seam::SeamReport report;
  report.reference = in.reference.value_or(config_.reference);
  out.clear();
  if (find_surfaces(in, report) && choose(in, report) && fit(in, report)) {
    build_curve(in, report, out);
  }
  return report;
}

bool OpenSeamChain::find_surfaces(const SeamInput& in, seam::SeamReport& report) noexcept {
  const seam::CellMap::Report cells = cells_.run(in.cloud_base);
  report.refusal = enter_cells(cells, report);
  if (report.refusal != Refusal::kNone) {
    return false;
  }
  cell_mm_ = cells.scale.cell_mm;
  tolerance_mm_ = tolerance_mm_of(cells);
  surfaces_.run(cells_.cells(), cells.scale);
  report.num_surfaces = static_cast<std::uint32_t>(surfaces_.surfaces().size());
  report.refusal = report.num_surfaces == 0 ? Refusal::kOneSurface : Refusal::kNone;
  return report.num_surfaces > 0;
}

bool OpenSeamChain::choose(const SeamInput& in, seam::SeamReport& report) noexcept {
  Viewpoints viewpoints;
  seam::RingHint hint;
  hint.has_region = in.region.has_value();
  hint.region_min = in.region ? in.region->min_base : hint.region_min;
  hint.region_max = in.region ? in.region->max_base : hint.region_max;
  hint.viewpoints = all_viewpoints(in.views, viewpoints);
  found_.clear();
  fillets_.run(cells_.cells(), surfaces_.surfaces(), {cell_mm_, tolerance_mm_}, hint, found_);
  slits_.run(in.cloud_base, surfaces_.surfaces(), {report.spacing_mm, tolerance_mm_}, hint, found_);
  std::sort(found_.items().begin(), found_.items().end(), is_better);
  const auto eligible = [](const OpenCandidate& c) { return c.fate == RingFate::kOutscored; };
  const auto best = std::find_if(found_.items().begin(), found_.items().end(), eligible);
  const bool any = best != found_.items().end();
  report.refusal = any              ? Refusal::kNone
                   : found_.empty() ? Refusal::kNoSeam
                                    : Refusal::kOutsideRegion;
  if (any) {
    best->fate = RingFate::kChosen;
    joint_ = best->joint;
    for (OpenCandidate& other : found_.items()) {
      const bool apart = (other.centre - best->centre).norm() > kSameSeamMm;
      if (eligible(other) && apart && other.score_mm > kEqualShare * best->score_mm) {
        other.fate = RingFate::kEqual;
        report.refusal = Refusal::kTwoSeams;
      }
    }
    if (best->joint.kind == seam::OpenKind::kButt) {
      seam::SlitFinder::lay_track(*best, kSlitStepMm, track_);
    } else {
      track_.copy(fillets_.walk(cells_.cells(), joint_, {cell_mm_, tolerance_mm_}));
    }
  }
  report.num_candidates =
      static_cast<std::uint32_t>(std::min(found_.size(), seam::SeamReport::kMaxCandidates));
  std::transform(found_.view().begin(),
                 found_.view().begin() + static_cast<std::ptrdiff_t>(report.num_candidates),
                 report.candidates.begin(), shown);
  return report.refusal == Refusal::kNone;
}

bool OpenSeamChain::fit(const SeamInput& in, seam::SeamReport& report) noexcept {
  seam::OpenSides& sides = sides_[0];
  const bool fitted =
      sides.run(in.cloud_base.points, {report.spacing_mm, tolerance_mm_}, joint_, track_);
  report.refusal = !fitted                   ? Refusal::kLowCoverage
                   : sides.num_dropped() > 0 ? Refusal::kFull
                                             : Refusal::kNone;
  if (report.refusal != Refusal::kNone) {
    return false;
  }
  seam::JointReport& joint = report.joint;
  joint.shell = joint_.surface[0];
  joint.nozzle = joint_.surface[1];
  joint.shell_harmonics = sides.side(0).deviation.order();
  joint.nozzle_harmonics = sides.side(1).deviation.order();
  joint.num_shell_points = static_cast<std::uint32_t>(sides.side(0).points.size());
  joint.num_nozzle_points = static_cast<std::uint32_t>(sides.side(1).points.size());
  report.quality.normal = sides.stats_of(0);
  report.quality.lateral = sides.stats_of(1);
  report.end_sigma_mm = sides.end_sigma_mm();
  const bool has = seam::OpenCurve::has(report.reference, joint_, sides);
  report.refusal = has ? Refusal::kNone : Refusal::kNoSuchReference;
  return has;
}

void OpenSeamChain::build_curve(const SeamInput& in, seam::SeamReport& report,
                                Buffer<seam::SeamPoint>& out) noexcept {
  const seam::OpenSides& sides = sides_[0];
  const Eigen::Vector3d middle = track_.at(0.5 * track_.length_mm()).p;
  const seam::ErrorSources errors{.pose_sigma_mm = pose_sigma_of(in.views, middle),
                                  .depth_sigma_mm = config_.scanner_sigma_mm,
                                  .hand_eye_sigma_mm = config_.hand_eye_sigma_mm};
  seam::OpenCurve curve;
  const seam::OpenCurve::Report built =
      curve.run({report.reference, config_.point_spacing_mm, config_.counter_clockwise}, joint_,
                track_, sides, errors, out);
  if (!built.placed) {
    out.clear();
    report.refusal = built.full ? Refusal::kFull : Refusal::kNoSeam;
    return;
  }
  report.length_mm = built.length_mm;
  sides.report(built.forward, report);
  seam::describe_curve(out.view(), report);
  seam::describe_widths(out.view(), report.joint);
  report.refusal =
      seam::verdict_of(report, {config_.min_coverage, config_.max_hole_rad, config_.max_sigma_mm});
}

}  // namespace dseam::pipeline
