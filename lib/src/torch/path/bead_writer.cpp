// SPDX-License-Identifier: Apache-2.0
#include "bead_writer.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::torch {
namespace {

using Eigen::Vector3d;

constexpr double kWeaveToleranceMm = 0.005;
constexpr double kAirStepMm = 2.0;
constexpr double kFewestSteps = 4.0;

Eigen::Quaterniond about(const Vector3d& axis, double angle_rad) noexcept {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

}  // namespace

TorchPose lifted(const TorchPose& pose, double height_mm) noexcept {
  return {pose.p_base - height_mm * (pose.q_base_torch * Vector3d::UnitZ()), pose.q_base_torch};
}

void BeadWriter::begin_pass(std::uint8_t index) noexcept {
  pass_ = &config_.passes[index];
  index_ = index;
  start_mm_ = config_.start_mm + pass_->start_shift_mm;
}

void BeadWriter::write(const Bead& bead) noexcept {
  bead_ = bead;
  const double limit = config_.max_wrist_turn_rad;
  unwind_rad_ = 0.0;
  const double turn = bead_turn();
  // What a bead alone turns the wrist beyond the limit is taken out along the bead.
  unwind_rad_ = turn - std::clamp(turn, -limit, limit);
  report_.unwound_rad += std::abs(unwind_rad_);
  approach();
  lead_in();
  weld();
  finish();
  ++report_.beads;
}

TorchPose BeadWriter::centre(double x_mm) const noexcept {
  const TorchPoint point = seam_at(x_mm);
  TorchPose pose = point.pose;
  pose.p_base += pass_->across_mm * point.across + pass_->out_mm * point.out;
  pose.q_base_torch =
      about(point.out.cross(point.across), pass_->work_offset_rad) * pose.q_base_torch;
  const double share = std::clamp((x_mm - from_mm()) / (bead_.end_mm - from_mm()), 0.0, 1.0);
  pose.q_base_torch = pose.q_base_torch * about(Vector3d::UnitZ(), -unwind_rad_ * share);
  return pose;
}

TorchPose BeadWriter::woven(const TorchPose& pose, double x_mm) const noexcept {
  const WeaveOffset offset = offset_at(pass_->weave, x_mm);
  return {
      pose.p_base + pose.q_base_torch * Vector3d(offset.along_mm, offset.across_mm, -offset.out_mm),
      pose.q_base_torch};
}

std::uint8_t BeadWriter::schedule_at(double s_mm) const noexcept {
  const double length = curve_.length_mm();
  const double s = curve_.closed() ? s_mm - length * std::floor(s_mm / length) : s_mm;
  for (std::size_t i = 0; i < config_.num_sectors; ++i) {
    const Sector& sector = config_.sectors[i];
    const bool after = s >= sector.from_mm;
    const bool before = s < sector.to_mm;
    const bool inside = sector.from_mm <= sector.to_mm ? after && before : after || before;
    if (inside && sector.pass == index_) {
      return sector.schedule;
    }
  }
  return pass_->schedule;
}

/// The confidence matters only where the arc burns; a crater is filled everywhere alike.
Stroke BeadWriter::over(const TorchPoint& point, Stroke s) const noexcept {
  s.confidence = s.arc ? point.confidence : seam::Confidence::kHigh;
  s.schedule = s.segment == Segment::kCrater ? s.schedule : schedule_at(point.s_mm);
  return s;
}

/// Turn about the wire along the bead in hand.
double BeadWriter::bead_turn() const noexcept {
  return curve_.wrist_turn(start_mm_ + from_mm(), start_mm_ + bead_.end_mm) - unwind_rad_;
}

/// Greatest wrist turn up to the end of the coming bead when the torch gets there this way.
double BeadWriter::wrist_after(double way_mm) const noexcept {
  const double there =
      wrist_rad_ + curve_.wrist_turn(at_mm_, at_mm_ + way_mm) + unwound_before_rad_;
  return std::max(std::abs(there), std::abs(there + bead_turn()));
}

/// The shortest way round, on to the coming bead or back, that keeps the wrist within its limit
/// up to the bead's end; without one, the way that turns it least.
double BeadWriter::way_to_next_bead() const noexcept {
  const double way_mm = start_mm_ + from_mm() - at_mm_;
  if (!curve_.closed()) {
    return way_mm;
  }
  const double length = curve_.length_mm();
  const double ahead_mm = way_mm - length * std::floor(way_mm / length);
  const double ways[] = {ahead_mm, ahead_mm - length, ahead_mm - 2.0 * length};
  double best_mm = ways[0];
  for (const double candidate : ways) {
    const double turn = std::max(wrist_after(candidate), config_.max_wrist_turn_rad);
    const double best_turn = std::max(wrist_after(best_mm), config_.max_wrist_turn_rad);
    const bool shorter = std::abs(candidate) < std::abs(best_mm);
    best_mm = turn < best_turn || (turn == best_turn && shorter) ? candidate : best_mm;
  }
  return best_mm;
}

void BeadWriter::note_wrist(double turn_rad) noexcept {
  wrist_rad_ += turn_rad;
  report_.wrist_turn_rad = std::max(report_.wrist_turn_rad, std::abs(wrist_rad_));
}

void BeadWriter::approach() noexcept {
  const Stroke air = stroke(Segment::kApproach, config_.travel_mm_s);
  const TorchPose begin = torch(from_mm());
  if (report_.beads > 0) {
    transfer(air);
  } else if (now_ != nullptr) {
    writer_.move_to(*now_, 0.0, air);
  }
  writer_.line_to(lifted(begin, config_.approach_mm), kAirStepMm, air);
  writer_.line_to(lifted(begin, config_.lead_in_mm), kAirStepMm, air);
  writer_.line_to(begin, config_.step_mm, stroke(Segment::kLeadIn, config_.lead_mm_s));
}

/// From the last bead's end to this one's start on the retracted curve.
void BeadWriter::transfer(const Stroke& air) noexcept {
  const double way_mm = way_to_next_bead();
  note_wrist(curve_.wrist_turn(at_mm_, at_mm_ + way_mm) + unwound_before_rad_);
  const double steps = std::ceil(std::abs(way_mm) / kAirStepMm);
  for (double k = 1.0; k <= steps; k += 1.0) {
    const double u = k / steps;
    TorchPose pose = lifted(curve_.at(at_mm_ + u * way_mm).pose, config_.approach_mm);
    pose.q_base_torch =
        pose.q_base_torch * about(Vector3d::UnitZ(), -unwound_before_rad_ * (1.0 - u));
    const double step_mm = (pose.p_base - writer_.last().p_base).norm();
    if (step_mm > 1e-6) {
      writer_.set_stroke(air);
      writer_.move_to(pose, step_mm, air);
    }
  }
  writer_.stop();
}

void BeadWriter::lead_in() noexcept {
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
  writer_.stand(config_.ignition_s, over(seam_at(bead_.begin_mm), s));
}

void BeadWriter::weld() noexcept {
  Stroke s = stroke(Segment::kWeld, pass_->speed_mm_s);
  s.arc = s.gas = s.wire = true;
  const double turn_mm = curve_.closed() ? curve_.length_mm() : bead_.end_mm;
  along(bead_.begin_mm, std::min(turn_mm, bead_.end_mm), s);
  s.segment = Segment::kOverlap;
  along(std::max(turn_mm, bead_.begin_mm), bead_.end_mm, s);
  writer_.stop();
  report_.weld_mm += bead_.end_mm - bead_.begin_mm;
  note_wrist(bead_turn());
}

/// Along the seam in even steps of the centre line; arc length between two of them from the chord
/// and the angle of the tangents.
void BeadWriter::along(double from, double to, const Stroke& s) noexcept {
  if (!(to > from)) {
    return;
  }
  const TorchPoint first = seam_at(from);
  writer_.set_stroke(over(first, s));
  const double step_mm = std::min(config_.step_mm, step_for(pass_->weave, kWeaveToleranceMm));
  const double steps = std::max(kFewestSteps, std::ceil((to - from) / step_mm));
  Vector3d before = centre(from).p_base;
  Vector3d t_before = first.tangent;
  for (double k = 1.0; k <= steps; k += 1.0) {
    const double x = from + (to - from) * k / steps;
    const TorchPose pose = centre(x);
    const TorchPoint here = seam_at(x);
    const double chord_mm = (pose.p_base - before).norm();
    const double bend = (here.tangent - t_before).squaredNorm() / 24.0;
    writer_.move_to(woven(pose, x), chord_mm * (1.0 + bend), over(here, s));
    before = pose.p_base;
    t_before = here.tangent;
  }
}

void BeadWriter::finish() noexcept {
  Stroke s = stroke(Segment::kCrater, config_.lead_mm_s);
  s.arc = s.gas = s.wire = true;
  s.schedule = pass_->crater_schedule;
  writer_.stand(config_.crater_s, over(seam_at(bead_.end_mm), s));
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

}  // namespace dseam::torch
