// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/path_planner.hpp"

#include <algorithm>
#include <cmath>

#include "bead_writer.hpp"

namespace dseam::torch {
namespace {

bool in(double v, double low, double high) noexcept { return v >= low && v <= high; }

bool is_valid(const Pass& p) noexcept {
  return in(p.speed_mm_s, 0.1, 200.0) && in(p.across_mm, -50.0, 50.0) &&
         in(p.out_mm, -50.0, 50.0) && in(p.work_offset_rad, -1.5, 1.5) &&
         in(p.start_shift_mm, -1e4, 1e4) && is_valid(p.weave);
}

bool is_valid(const Sector& s) noexcept { return in(s.from_mm, 0.0, 1e5) && in(s.to_mm, 0.0, 1e5); }

bool is_valid(const PathPlanner::Config& c) noexcept {
  const bool lengths = in(c.start_mm, -1e5, 1e5) && in(c.overlap_mm, 0.0, 1e4) &&
                       in(c.overlap_rad, 0.0, 6.2) && in(c.lead_in_mm, 0.0, 500.0) &&
                       in(c.approach_mm, c.lead_in_mm, 1000.0) && in(c.step_mm, 0.02, 10.0) &&
                       in(c.min_bead_mm, 0.0, 1e4) && in(c.max_start_mm, 0.0, 1e5) &&
                       in(c.resume.stopped_mm, 0.0, 1e5) && in(c.resume.run_up_mm, 0.0, 1e3) &&
                       in(c.resume.overlap_mm, 0.0, 1e3);
  const bool rest = in(c.travel_mm_s, 0.1, 5000.0) && in(c.lead_mm_s, 0.1, 5000.0) &&
                    in(c.preflow_s, 0.0, 60.0) && in(c.ignition_s, 0.0, 60.0) &&
                    in(c.crater_s, 0.0, 60.0) && in(c.postflow_s, 0.0, 60.0) &&
                    in(c.max_wrist_turn_rad, 0.1, 100.0);
  const auto valid = [](const auto& item) { return is_valid(item); };
  const bool counts = c.num_passes >= 1 && c.num_passes <= PathPlanner::kMaxPasses &&
                      c.num_sectors <= PathPlanner::kMaxSectors;
  return lengths && rest && counts &&
         std::all_of(c.passes.begin(), c.passes.begin() + c.num_passes, valid) &&
         std::all_of(c.sectors.begin(), c.sectors.begin() + c.num_sectors, valid);
}

/// Finds the next weldable stretch of a pass from `x_mm` on; false when there is none.
bool next_bead(const PathPlanner::Config& config, const TorchCurve& curve, double start_mm,
               double length_mm, double& x_mm, Bead& bead) noexcept {
  const double step_mm = std::min(curve.spacing_mm(), config.step_mm);
  const double steps = std::ceil(length_mm / step_mm);
  const auto weldable = [&](double x) { return curve.at(start_mm + x).weldable == Weldable::kYes; };
  for (double k = std::ceil(x_mm / step_mm - 1e-9); k <= steps; k += 1.0) {
    bead.begin_mm = std::min(k * step_mm, length_mm);
    if (!weldable(bead.begin_mm)) {
      continue;
    }
    bead.end_mm = bead.begin_mm;
    while (k < steps && weldable(std::min((k + 1.0) * step_mm, length_mm))) {
      k += 1.0;
      bead.end_mm = std::min(k * step_mm, length_mm);
    }
    if (bead.end_mm - bead.begin_mm >= std::max(config.min_bead_mm, step_mm)) {
      x_mm = bead.end_mm + step_mm;
      return true;
    }
  }
  return false;
}

/// Cuts off what was welded before the stop; false when nothing is left of the bead.
bool resume_in(const Resume& resume, std::uint8_t pass, Bead& bead) noexcept {
  if (!resume.active || pass != resume.pass) {
    return true;
  }
  if (bead.end_mm <= resume.stopped_mm) {
    return false;
  }
  if (bead.begin_mm < resume.stopped_mm) {
    const double begin_mm = std::max(bead.begin_mm, resume.stopped_mm - resume.overlap_mm);
    bead.run_up_mm = std::min(resume.run_up_mm, begin_mm - bead.begin_mm);
    bead.begin_mm = begin_mm;
  }
  return true;
}

/// With its overlap, on a closed curve.
double pass_length_mm(const PathPlanner::Config& config, const TorchCurve& curve) noexcept {
  if (!curve.closed()) {
    return curve.length_mm();
  }
  const double share = config.overlap_rad / (2.0 * std::numbers::pi);
  return curve.length_mm() + (share > 0.0 ? share * curve.length_mm() : config.overlap_mm);
}

/// False when no stretch of the pass may be welded.
bool write_pass(const PathPlanner::Config& config, const TorchCurve& curve, std::uint8_t pass,
                BeadWriter& beads, PathPlanner::Report& report) noexcept {
  beads.begin_pass(pass);
  const double length_mm = pass_length_mm(config, curve);
  double weldable_mm = 0.0;
  Bead bead;
  for (double x = 0.0; next_bead(config, curve, beads.pass_start_mm(), length_mm, x, bead);
       bead = {}) {
    weldable_mm += bead.end_mm - bead.begin_mm;
    if (resume_in(config.resume, pass, bead)) {
      beads.write(bead);
    }
  }
  report.skipped_mm += length_mm - weldable_mm;
  return weldable_mm > 0.0;
}

}  // namespace

Result<PathPlanner> PathPlanner::make(const Config& config) noexcept {
  if (!is_valid(config)) {
    return Errc::kInvalidArgument;
  }
  return PathPlanner(config);
}

PathPlanner::Report PathPlanner::run(const TorchCurveView& curve, Buffer<PathPoint>& out) noexcept {
  return plan(nullptr, curve, out);
}

PathPlanner::Report PathPlanner::run_from(const TorchPose& now, const TorchCurveView& curve,
                                          Buffer<PathPoint>& out) noexcept {
  return plan(&now, curve, out);
}

PathPlanner::Report PathPlanner::plan(const TorchPose* now, const TorchCurveView& view,
                                      Buffer<PathPoint>& out) noexcept {
  Report report;
  PathWriter writer(out);
  if (view.points.size() < 4 || !(view.length_mm > 0.0)) {
    return report;
  }
  if (now != nullptr && !is_near(*now, view)) {
    report.state = State::kStartTooFar;
    return report;
  }
  const TorchCurve curve(view);
  BeadWriter beads(config_, curve, now, writer, report);
  const std::uint8_t first = config_.resume.active ? config_.resume.pass : std::uint8_t{0};
  bool weldable = first >= config_.num_passes;
  for (std::uint8_t pass = first; pass < config_.num_passes; ++pass) {
    weldable = write_pass(config_, curve, pass, beads, report) || weldable;
  }
  if (report.beads > 0) {
    report.state = State::kPlanned;
  } else {
    report.state = weldable ? State::kNothingLeft : State::kNothingWeldable;
  }
  if (writer.full()) {
    out.clear();
    report.state = State::kFull;
  }
  report.points = static_cast<std::uint32_t>(out.size());
  return report;
}

bool PathPlanner::is_near(const TorchPose& now, const TorchCurveView& view) const noexcept {
  const double away_mm = (now.p_base - view.points[0].pose.p_base).norm();
  return away_mm <= config_.max_start_mm && std::abs(now.q_base_torch.norm() - 1.0) < 1e-6;
}

}  // namespace dseam::torch
