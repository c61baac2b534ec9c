// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/motion_gate.hpp"

#include <cmath>

namespace dseam::rt {
namespace {

bool is_finite(const trajectory::SetPoint& point) noexcept {
  return point.pose.p_base.allFinite() &&
         std::abs(point.pose.q_base_torch.norm() - 1.0) < 1e-3 &&  // NaN fails it too.
         std::isfinite(point.speed_mm_s) && std::isfinite(point.wire_feed_m_min) &&
         std::isfinite(point.voltage_v);
}

}  // namespace

Result<MotionGate> MotionGate::make(const Config& c) noexcept {
  const double limits[] = {c.max_start_mm,   c.max_start_rad,  c.max_step_mm,
                           c.max_step_rad,   c.max_speed_mm_s, c.max_acceleration_mm_s2,
                           c.max_jerk_mm_s3, c.max_turn_rad_s};
  for (const double limit : limits) {
    if (!(std::isfinite(limit) && limit > 0.0)) {
      return Errc::kInvalidArgument;
    }
  }
  if (!(c.workspace.low_mm.array() < c.workspace.high_mm.array()).all()) {
    return Errc::kInvalidArgument;
  }
  return MotionGate(c);
}

void MotionGate::restart(const torch::TorchPose& now) noexcept {
  last_ = now;
  seen_ = 0;
}

Fault MotionGate::check(const trajectory::SetPoint& point) noexcept {
  if (!is_finite(point)) {
    return Fault::kSetPointNotFinite;
  }
  if (!config_.workspace.contains(point.pose.p_base)) {
    return Fault::kOutsideWorkspace;
  }
  const Fault fault = seen_ == 0 ? check_start(point) : check_step(point);
  if (seen_ == 0) {
    velocity_mm_s_.setZero();
    acceleration_mm_s2_.setZero();
  }
  last_ = point.pose;
  last_us_ = point.t_us;
  ++seen_;
  return fault;
}

Fault MotionGate::check_start(const trajectory::SetPoint& point) const noexcept {
  const double away_mm = (point.pose.p_base - last_.p_base).norm();
  const double turned_rad = point.pose.q_base_torch.angularDistance(last_.q_base_torch);
  const bool here = away_mm <= config_.max_start_mm && turned_rad <= config_.max_start_rad;
  return here ? Fault::kNone : Fault::kSetPointJump;
}

Fault MotionGate::check_step(const trajectory::SetPoint& point) noexcept {
  if (point.t_us <= last_us_) {
    return Fault::kSetPointOrder;
  }
  const Eigen::Vector3d step_mm = point.pose.p_base - last_.p_base;
  const double turned_rad = point.pose.q_base_torch.angularDistance(last_.q_base_torch);
  if (step_mm.norm() > config_.max_step_mm || turned_rad > config_.max_step_rad) {
    return Fault::kSetPointJump;
  }
  const double dt_s = 1e-6 * (point.t_us - last_us_);
  const Eigen::Vector3d velocity = step_mm / dt_s;
  const Eigen::Vector3d acceleration = (velocity - velocity_mm_s_) / dt_s;
  const Eigen::Vector3d jerk = (acceleration - acceleration_mm_s2_) / dt_s;
  velocity_mm_s_ = velocity;
  acceleration_mm_s2_ = acceleration;
  if (velocity.norm() > config_.max_speed_mm_s) {
    return Fault::kSetPointSpeed;
  }
  if (acceleration.norm() > config_.max_acceleration_mm_s2) {
    return Fault::kSetPointAcceleration;
  }
  if (jerk.norm() > config_.max_jerk_mm_s3) {
    return Fault::kSetPointJerk;
  }
  return turned_rad > config_.max_turn_rad_s * dt_s ? Fault::kSetPointTurn : Fault::kNone;
}

/// As if it were sent again and again: one step brings the speed to zero, the next one the
/// acceleration.
bool MotionGate::can_stand_at(const trajectory::SetPoint& last, std::uint32_t step_us) noexcept {
  trajectory::SetPoint still = last;
  for (int i = 0; i < 2; ++i) {
    still.t_us += step_us;
    if (check(still) != Fault::kNone) {
      return false;
    }
  }
  return true;
}

MotionGate::Verdict MotionGate::check_all(const torch::TorchPose& now,
                                          trajectory::SetPointView points) noexcept {
  restart(now);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Fault fault = check(points[i]);
    if (fault != Fault::kNone) {
      return {fault, i};
    }
  }
  if (points.size() < 2) {
    return {};
  }
  const std::size_t last = points.size() - 1;
  const bool stands = can_stand_at(points[last], points[last].t_us - points[last - 1].t_us);
  return stands ? Verdict{} : Verdict{Fault::kSetPointEnd, last};
}

}  // namespace dseam::rt
