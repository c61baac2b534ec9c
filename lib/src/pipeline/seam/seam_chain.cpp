// SPDX-License-Identifier: Apache-2.0
#include "dseam/pipeline/seam_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "dseam/seam/curve/quality.hpp"
#include "pipeline/seam/seam_scales.hpp"

namespace dseam::pipeline {
namespace {

using seam::Refusal;

bool is_valid(const SeamChain::Config& c) noexcept {
  return c.min_coverage >= 0.0 && c.min_coverage <= 1.0 && c.max_hole_rad >= 0.0 &&
         c.max_sigma_mm > 0.0 && c.point_spacing_mm > 0.0 && std::isfinite(c.point_spacing_mm) &&
         std::isfinite(c.start_angle_rad) && c.hand_eye_sigma_mm >= 0.0 &&
         c.scanner_sigma_mm >= 0.0 && std::isfinite(c.scanner_sigma_mm) &&
         std::isfinite(c.hand_eye_sigma_mm);
}

std::span<const Eigen::Vector3d> viewpoints_of(std::span<const splice::SplicedView> views,
                                               Viewpoints& storage) noexcept {
  std::size_t count = 0;
  for (const splice::SplicedView& view : views) {
    if (view.state == splice::ViewState::kUsed && count < storage.size()) {
      storage[count++] = view.T_base_camera.translation_mm;
    }
  }
  return std::span(storage).first(count);
}

seam::RingHint hint_of(const SeamInput& in, Viewpoints& storage) noexcept {
  seam::RingHint hint;
  if (in.region) {
    hint.has_region = true;
    hint.region_min = in.region->min_base;
    hint.region_max = in.region->max_base;
  }
  hint.radius_mm = in.expected_radius_mm.value_or(0.0);
  hint.viewpoints = viewpoints_of(in.views, storage);
  return hint;
}

// So little of a ring was seen that it may be the wrong one. A plane through parts of several
// surfaces is easily found; other surfaces are not.
bool is_badly_seen(const seam::SeamReport& report) noexcept {
  constexpr double kWellSeen = 0.8;
  switch (report.refusal) {
    case Refusal::kNoRing:
      return true;
    case Refusal::kTwoRings:
      return report.candidates[0].coverage < kWellSeen;
    case Refusal::kLowCoverage:
      return report.joint.shell.kind == seam::SurfaceKind::kPlane;
    default:
      return false;
  }
}

Refusal too_few_surfaces(std::span<const seam::FoundSurface> surfaces) noexcept {
  const bool plane = !surfaces.empty() && surfaces[0].surface.kind == seam::SurfaceKind::kPlane;
  return surfaces.size() == 1 && plane ? Refusal::kCoplanar : Refusal::kOneSurface;
}

}  // namespace

std::size_t SeamChain::bytes(const Capacity& capacity) noexcept {
  const std::size_t cells = num_seam_cells(capacity);
  return seam::CellMap::bytes(cells) + seam::SurfaceFinder::bytes(cells) +
         seam::RingFinder::bytes() + seam::JointFit::bytes(capacity.max_points) +
         seam::EdgeScanner::bytes(capacity.max_edge_intervals) + Arena::bytes<Workspace>(1) +
         Arena::bytes<float>(capacity.max_points / 2);
}

SeamChain::SeamChain(const Config& config, const Capacity& capacity, Arena& arena) noexcept
    : config_(config),
      cells_(num_seam_cells(capacity), arena),
      surfaces_(num_seam_cells(capacity), arena),
      rings_(arena),
      fit_(capacity.max_points, arena),
      edges_(capacity.max_edge_intervals, arena),
      work_(arena.take<Workspace>(1)),
      scratch_(arena.take<float>(capacity.max_points / 2)) {}

Result<SeamChain> SeamChain::make(const Config& config, const Capacity& capacity,
                                  Arena& arena) noexcept {
  if (!is_valid(config) || capacity.max_points < 64) {
    return Errc::kInvalidArgument;
  }
  const SeamChain chain(config, capacity, arena);
  if (arena.exhausted()) {
    return Errc::kOutOfMemory;
  }
  return chain;
}

seam::SeamReport SeamChain::run(const SeamInput& in, Buffer<seam::SeamPoint>& out) noexcept {
  out.clear();
  seam::SeamReport report;
  attempt(in, Search::kSurfaces, report, out);
  if (is_badly_seen(report)) {
    seam::SeamReport at_feet;
    report = attempt(in, Search::kFeet, at_feet, out) ? at_feet : report;
  }
  return report;
}

// True where there are two surfaces to fit, whatever becomes of the seam; else `out` is left alone.
bool SeamChain::attempt(const SeamInput& in, Search search, seam::SeamReport& report,
                        Buffer<seam::SeamPoint>& out) noexcept {
  report = {};
  report.reference = in.reference.value_or(config_.reference);
  seam::Joint joint;
  if (!find_joint(in, search, report, joint) || !fit_joint(in, joint, report)) {
    return false;
  }
  out.clear();
  if (find_edges(in, report)) {
    build_curve(in, report, out);
  }
  return true;
}

bool SeamChain::find_joint(const SeamInput& in, Search search, seam::SeamReport& report,
                           seam::Joint& joint) noexcept {
  const seam::CellMap::Report cells = cells_.run(in.cloud_base);
  report.refusal = enter_cells(cells, report);
  if (report.refusal != Refusal::kNone) {
    return false;
  }
  tolerance_mm_ = tolerance_mm_of(cells);
  surfaces_.run(cells_.cells(), cells.scale);
  const auto surfaces = surfaces_.surfaces();
  report.num_surfaces = static_cast<std::uint32_t>(surfaces.size());
  if (surfaces.size() < 2) {
    report.refusal = too_few_surfaces(surfaces);
    return false;
  }
  Viewpoints viewpoints;
  const seam::RingHint hint = hint_of(in, viewpoints);
  const seam::RingFinder::Choice choice =
      search == Search::kSurfaces ? rings_.run(cells_.cells(), surfaces, cells.scale, hint, report)
                                  : rings_.run_at_feet(in.cloud_base.points, cells_.cells(),
                                                       surfaces, cells.scale, hint, report);
  report.refusal = choice.refusal;
  joint = choice.joint;
  bore_ = choice.bore;
  return choice.refusal == Refusal::kNone;
}

bool SeamChain::fit_joint(const SeamInput& in, const seam::Joint& joint,
                          seam::SeamReport& report) noexcept {
  if (!fit_.run(in.cloud_base.points, joint, bore_,
                {report.spacing_mm, report.noise_mm, tolerance_mm_})) {
    report.refusal = Refusal::kLowCoverage;
    return false;
  }
  if (fit_.num_dropped() > 0) {
    report.refusal = Refusal::kFull;
    return false;
  }
  seam::describe_joint(fit_, report.joint);
  seam::describe_residuals(fit_, scratch_, report.quality);
  return true;
}

// False where there is no room for all that was seen.
bool SeamChain::scan_edge(const SeamInput& in, seam::EndingSurface::Which which,
                          seam::SeamReport& report) noexcept {
  const seam::EndingSurface surface(fit_, which);
  if (in.frames.empty()) {
    edges_.run(surface, report.spacing_mm);
  } else {
    edges_.run(in.frames, in.views, surface, report.noise_mm);
  }
  report.joint.num_edge_intervals += static_cast<std::uint32_t>(edges_.intervals().size());
  return !edges_.full();
}

// A nozzle that goes through the shell's hole does not end at the joint: the second search is for
// one that was set on.
bool SeamChain::find_edges(const SeamInput& in, seam::SeamReport& report) noexcept {
  using Which = seam::EndingSurface::Which;
  seam::EdgeCurve& shell = work_[0].shell_edge;
  seam::EdgeCurve& nozzle = work_[0].nozzle_edge;
  found_ = {};
  report.refusal = Refusal::kFull;
  if (!scan_edge(in, Which::kShell, report)) {
    return false;
  }
  if (shell.fit(edges_.intervals(), edges_.smear_mm()) && seam::describe_gap(shell, report.joint)) {
    found_.shell = &shell;
  } else if (!scan_edge(in, Which::kNozzle, report)) {
    return false;
  } else if (nozzle.fit(edges_.intervals()) && seam::describe_mismatch(nozzle, report.joint)) {
    // Under a nozzle's end the shell is near: lines go down by and by there without any smear.
    found_.nozzle = &nozzle;
  }
  report.refusal = has(report.reference) ? Refusal::kNone : Refusal::kNoSuchReference;
  return report.refusal == Refusal::kNone;
}

bool SeamChain::has(seam::ReferenceCurve reference) const noexcept {
  switch (reference) {
    case seam::ReferenceCurve::kGapMiddle:
      return found_.shell != nullptr || found_.nozzle != nullptr;
    case seam::ReferenceCurve::kNozzleEdge:
      return found_.nozzle != nullptr;
    default:
      return true;
  }
}

void SeamChain::build_curve(const SeamInput& in, seam::SeamReport& report,
                            Buffer<seam::SeamPoint>& out) noexcept {
  Workspace& work = work_[0];
  work.coverage.run(fit_, found_, report.spacing_mm);
  Viewpoints storage;
  seam::ErrorSources errors{.pose_sigma_mm = pose_sigma_of(in.views, fit_.joint().nozzle.point),
                            .depth_sigma_mm = config_.scanner_sigma_mm,
                            .hand_eye_sigma_mm = config_.hand_eye_sigma_mm,
                            .hidden_gap_mm = work.coverage.hidden_gap_mm()};
  if (!in.frames.empty()) {
    errors.viewpoints = viewpoints_of(in.views, storage);
  }
  report.joint.hidden_gap_mm = errors.hidden_gap_mm;
  const seam::CurveBuilder::Report built =
      work.builder.run({report.reference, config_.point_spacing_mm, config_.start_angle_rad,
                        config_.counter_clockwise},
                       fit_, found_, work.coverage, errors, out);
  if (!built.placed) {
    report.refusal = built.full ? Refusal::kFull : Refusal::kNoRing;
    return;
  }
  report.closed = true;
  report.length_mm = built.length_mm;
  report.quality.closure_mm = built.closure_mm;
  work.coverage.report(config_.counter_clockwise, report);
  seam::describe_curve(out.view(), report);
  report.refusal =
      seam::verdict_of(report, {config_.min_coverage, config_.max_hole_rad, config_.max_sigma_mm});
}

}  // namespace dseam::pipeline
