// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/path_planner.hpp"

#include <algorithm>
#include <cmath>

#include "path_writer.hpp"
#include "torch_curve.hpp"

namespace dseam::torch {
namespace {

using Eigen::Vector3d;

constexpr double kWeaveToleranceMm = 0.005;
constexpr double kAirStepMm = 2.0;

bool in(double v, double low, double high) noexcept { return v >= low && v <= high; }

bool is_valid(const Pass& p) noexcept {
  return in(p.speed_mm_s, 0.1, 200.0) && in(p.across_mm, -50.0, 50.0) &&
         in(p.out_mm, -50.0, 50.0) && in(p.work_offset_rad, -1.5, 1.5) &&
         in(p.start_shift_mm, -1e4, 1e4) && is_valid(p.weave);
}

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
  const std::size_t n = c.num_passes;
  return lengths && rest && n >= 1 && n <= PathPlanner::kMaxPasses &&
         std::all_of(c.passes.begin(), c.passes.begin() + c.num_passes,
                     [](const Pass& p) { return is_valid(p); });
}

TorchPose lifted(const TorchPose& pose, double height_mm) noexcept {
  return {pose.p_base - height_mm * (pose.q_base_torch * Vector3d::UnitZ()), pose.q_base_torch};
}

Eigen::Quaterniond about(const Vector3d& axis, double angle_rad) noexcept {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

/// A stretch of a pass to weld, in travel from the pass' start.
struct Bead {
  double begin_mm = 0.0;
  double end_mm = 0.0;
  double run_up_mm = 0.0;
};

/// Writes the beads of one path one after the other and keeps account of the wrist.
class BeadWriter {
 public:
  BeadWriter(const PathPlanner::Config& config, const TorchCurve& curve, const TorchPose* now,
             PathWriter& writer, PathPlanner::Report& report) noexcept
      : config_(config), curve_(curve), now_(now), writer_(writer), report_(report) {}

  void begin_pass(std::uint8_t index) noexcept {
    pass_ = &config_.passes[index];
    index_ = index;
    start_mm_ = config_.start_mm + pass_->start_shift_mm;
  }
  [[nodiscard]] double pass_start_mm() const noexcept { return start_mm_; }
  void write(const Bead& bead) noexcept {
    bead_ = bead;
    unwind_rad_ = excess_turn();
    approach();
    lead_in();
    weld();
    finish();
    ++report_.beads;
  }

 private:
  /// The torch on the pass' centre line, `x_mm` from the pass' start.
  [[nodiscard]] TorchPose centre(double x_mm) const noexcept {
    const TorchPoint point = curve_.at(start_mm_ + x_mm);
    TorchPose pose = point.pose;
    pose.p_base += pass_->across_mm * point.across + pass_->out_mm * point.out;
    pose.q_base_torch =
        about(point.out.cross(point.across), pass_->work_offset_rad) * pose.q_base_torch;
    const double share = std::clamp((x_mm - from_mm()) / (bead_.end_mm - from_mm()), 0.0, 1.0);
    pose.q_base_torch = pose.q_base_torch * about(Vector3d::UnitZ(), -unwind_rad_ * share);
    return pose;
  }
  [[nodiscard]] TorchPose woven(const TorchPose& pose, double x_mm) const noexcept {
    const WeaveOffset offset = offset_at(pass_->weave, x_mm);
    return {pose.p_base +
                pose.q_base_torch * Vector3d(offset.along_mm, offset.across_mm, -offset.out_mm),
            pose.q_base_torch};
  }
  [[nodiscard]] TorchPose torch(double x_mm) const noexcept { return woven(centre(x_mm), x_mm); }
  [[nodiscard]] double from_mm() const noexcept { return bead_.begin_mm - bead_.run_up_mm; }
  [[nodiscard]] Stroke stroke(Segment segment, double speed_mm_s) const noexcept {
    return {segment, speed_mm_s, false, false, false, index_, pass_->schedule};
  }

  /// What a bead alone turns the wrist beyond the limit; it is taken out along the bead.
  [[nodiscard]] double excess_turn() const noexcept {
    const double turn = curve_.wrist_turn(start_mm_ + from_mm(), start_mm_ + bead_.end_mm);
    const double limit = config_.max_wrist_turn_rad;
    return turn - std::clamp(turn, -limit, limit);
  }
  void note_wrist(double turn_rad) noexcept {
    wrist_rad_ += turn_rad;
    report_.wrist_turn_rad = std::max(report_.wrist_turn_rad, std::abs(wrist_rad_));
  }

  void approach() noexcept {
    const Stroke air = stroke(Segment::kApproach, config_.travel_mm_s);
    const TorchPose above = lifted(torch(from_mm()), config_.approach_mm);
    if (report_.beads > 0) {
      transfer(air);
    } else if (now_ != nullptr) {
      writer_.move_to(*now_, 0.0, air);
    }
    writer_.line_to(above, kAirStepMm, air);
    writer_.line_to(lifted(torch(from_mm()), config_.lead_in_mm), kAirStepMm, air);
    writer_.line_to(torch(from_mm()), config_.step_mm, stroke(Segment::kLeadIn, config_.lead_mm_s));
  }

  /// From the last bead's end to this one's start on the retracted curve: the shorter way round
  /// unless the wrist would end beyond its limit.
  void transfer(const Stroke& air) noexcept {
    const double to_mm = start_mm_ + from_mm();
    double way_mm = to_mm - at_mm_;
    if (curve_.closed()) {
      way_mm -= curve_.length_mm() * std::floor(way_mm / curve_.length_mm());
      const double back_mm = way_mm - curve_.length_mm();
      const double ahead = wrist_after(way_mm);
      const double behind = wrist_after(back_mm);
      const bool shorter_back = -back_mm < way_mm;
      const bool fits = std::max(ahead, behind) <= config_.max_wrist_turn_rad;
      way_mm = (fits ? shorter_back : behind < ahead) ? back_mm : way_mm;
    }
    note_wrist(curve_.wrist_turn(at_mm_, at_mm_ + way_mm) + unwound_before_rad_);
    report_.unwound_rad += std::abs(unwound_before_rad_);
    const double steps = std::ceil(std::abs(way_mm) / kAirStepMm);
    const Eigen::Quaterniond untwist = about(Vector3d::UnitZ(), -unwound_before_rad_);
    for (double k = 1.0; k <= steps; k += 1.0) {
      const double u = k / steps;
      TorchPose pose = lifted(curve_.at(at_mm_ + u * way_mm).pose, config_.approach_mm);
      pose.q_base_torch = pose.q_base_torch * untwist.slerp(u, Eigen::Quaterniond::Identity());
      const double step_mm = (pose.p_base - writer_.last().p_base).norm();
      if (step_mm > 1e-6) {
        writer_.set_stroke(air);
        writer_.move_to(pose, step_mm, air);
      }
    }
    writer_.stop();
  }
  /// Greatest wrist turn up to the end of the coming bead when the torch gets there this way.
  [[nodiscard]] double wrist_after(double way_mm) const noexcept {
    const double there =
        wrist_rad_ + curve_.wrist_turn(at_mm_, at_mm_ + way_mm) + unwound_before_rad_;
    const double bead =
        curve_.wrist_turn(start_mm_ + from_mm(), start_mm_ + bead_.end_mm) - unwind_rad_;
    return std::max(std::abs(there), std::abs(there + bead));
  }

  void lead_in() noexcept {
    Stroke s = stroke(Segment::kLeadIn, config_.lead_mm_s);
    s.gas = true;
    writer_.stand(config_.preflow_s, s);
    if (bead_.run_up_mm > 0.0) {
      s.speed_mm_s = pass_->speed_mm_s;
      along(from_mm(), bead_.begin_mm, s);
      return;
    }
    s.segment = Segment::kWeld;
    s.arc = s.wire = true;
    writer_.stand(config_.ignition_s, s);
  }

  void weld() noexcept {
    Stroke s = stroke(Segment::kWeld, pass_->speed_mm_s);
    s.arc = s.gas = s.wire = true;
    const double turn_mm = curve_.closed() ? curve_.length_mm() : bead_.end_mm;
    along(bead_.begin_mm, std::min(turn_mm, bead_.end_mm), s);
    s.segment = Segment::kOverlap;
    along(std::max(turn_mm, bead_.begin_mm), bead_.end_mm, s);
    writer_.stop();
    report_.weld_mm += bead_.end_mm - bead_.begin_mm;
    note_wrist(curve_.wrist_turn(start_mm_ + from_mm(), start_mm_ + bead_.end_mm) - unwind_rad_);
  }

  /// Along the seam in even steps of the centre line; arc length between two of them from the
  /// chord and the angle of the tangents.
  void along(double from, double to, const Stroke& s) noexcept {
    if (!(to > from)) {
      return;
    }
    writer_.set_stroke(s);
    const double step_mm = std::min(config_.step_mm, step_for(pass_->weave, kWeaveToleranceMm));
    const double steps = std::max(4.0, std::ceil((to - from) / step_mm));
    TorchPose before = centre(from);
    Vector3d t_before = curve_.at(start_mm_ + from).tangent;
    for (double k = 1.0; k <= steps; k += 1.0) {
      const double x = from + (to - from) * k / steps;
      const TorchPose pose = centre(x);
      const Vector3d t = curve_.at(start_mm_ + x).tangent;
      const double chord_mm = (pose.p_base - before.p_base).norm();
      writer_.move_to(woven(pose, x), chord_mm * (1.0 + (t - t_before).squaredNorm() / 24.0), s);
      before = pose;
      t_before = t;
    }
  }

  void finish() noexcept {
    Stroke s = stroke(Segment::kCrater, config_.lead_mm_s);
    s.arc = s.gas = s.wire = true;
    s.schedule = pass_->crater_schedule;
    writer_.stand(config_.crater_s, s);
    s = stroke(Segment::kLeadOut, config_.lead_mm_s);
    s.gas = true;
    writer_.stand(config_.postflow_s, s);
    s.gas = false;
    const TorchPose end = writer_.last();
    writer_.line_to(lifted(end, config_.lead_in_mm), config_.step_mm, s);
    writer_.line_to(lifted(end, config_.approach_mm), kAirStepMm,
                    stroke(Segment::kRetract, config_.travel_mm_s));
    at_mm_ = start_mm_ + bead_.end_mm;
    unwound_before_rad_ = unwind_rad_;
  }

  const PathPlanner::Config& config_;
  const TorchCurve& curve_;
  const TorchPose* now_;
  PathWriter& writer_;
  PathPlanner::Report& report_;
  const Pass* pass_ = nullptr;
  std::uint8_t index_ = 0;
  double start_mm_ = 0.0;
  Bead bead_;
  double unwind_rad_ = 0.0;          ///< Taken out along the bead in hand,
  double unwound_before_rad_ = 0.0;  ///< and along the one before, to be given back in the air.
  double wrist_rad_ = 0.0;
  double at_mm_ = 0.0;  ///< Where on the curve the last bead ended.
};

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
  bool seen = false;
  for (std::uint8_t pass = first; pass < config_.num_passes; ++pass) {
    beads.begin_pass(pass);
    const double overlap_mm = config_.overlap_rad > 0.0
                                  ? config_.overlap_rad / (2.0 * std::numbers::pi) * view.length_mm
                                  : config_.overlap_mm;
    const double length_mm = view.length_mm + (view.closed ? overlap_mm : 0.0);
    double welded_mm = 0.0;
    Bead bead;
    for (double x = 0.0; next_bead(config_, curve, beads.pass_start_mm(), length_mm, x, bead);
         bead = {}) {
      seen = true;
      welded_mm += bead.end_mm - bead.begin_mm;
      if (resume_in(config_.resume, pass, bead)) {
        beads.write(bead);
      }
    }
    report.skipped_mm += length_mm - welded_mm;
  }
  report.state = report.beads > 0 ? State::kPlanned
                                  : (seen || first >= config_.num_passes ? State::kNothingLeft
                                                                         : State::kNothingWeldable);
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
