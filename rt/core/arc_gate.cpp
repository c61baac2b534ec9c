// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/arc_gate.hpp"

#include <algorithm>
#include <cmath>

namespace dseam::rt {

Result<ArcGate> ArcGate::make(const Config& c) noexcept {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0.0; };
  const bool limits = positive(c.max_tracking_mm) && positive(c.speed_tolerance_mm_s) &&
                      positive(c.speed_tolerance_share) && positive(c.max_corridor_mm) &&
                      c.min_confidence <= seam::Confidence::kHigh;
  const bool times = c.max_data_age_ns > 0 && c.max_pose_age_ns > 0 && c.max_stream_age_ns > 0 &&
                     c.max_standing_ns > 0;
  const bool box = (c.workspace.low_mm.array() < c.workspace.high_mm.array()).all();
  if (!limits || !times || !box) {
    return Errc::kInvalidArgument;
  }
  return ArcGate(c);
}

bool ArcGate::speed_is_right(const ArcInputs& in) const noexcept {
  const double tolerance =
      std::max(config_.speed_tolerance_mm_s, config_.speed_tolerance_share * in.planned_high_mm_s);
  return in.speed_mm_s >= in.planned_low_mm_s - tolerance &&
         in.speed_mm_s <= in.planned_high_mm_s + tolerance;
}

Fault ArcGate::check(const ArcInputs& in) const noexcept {
  // Each comparison is written so that NaN loses the condition.
  const struct {
    bool held;
    Fault otherwise;
  } conditions[] = {
      {in.armed, Fault::kNotArmed},
      {in.data_age_ns <= config_.max_data_age_ns && in.pose_age_ns <= config_.max_pose_age_ns,
       Fault::kDataStale},
      {in.confidence >= config_.min_confidence, Fault::kConfidenceLow},
      {in.stream_age_ns <= config_.max_stream_age_ns, Fault::kStreamStopped},
      {in.bus <= hal::BusState::kErrorWarning, Fault::kBusNotActive},  // A warning is still active.
      {in.tracking_mm <= config_.max_tracking_mm, Fault::kTrackingError},
      {speed_is_right(in), Fault::kSpeedOutOfWindow},
      {config_.workspace.contains(in.p_base), Fault::kOutsideWorkspace},
      {in.corridor_mm <= config_.max_corridor_mm, Fault::kOutsideCorridor},
      {!in.overrun, Fault::kOverrun},
      {in.standing_ns <= config_.max_standing_ns, Fault::kStandstill}};
  for (const auto& condition : conditions) {
    if (!condition.held) {
      return condition.otherwise;
    }
  }
  return Fault::kNone;
}

}  // namespace dseam::rt
