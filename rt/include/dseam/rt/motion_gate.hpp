// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "dseam/base/expects.hpp"
#include "dseam/base/result.hpp"
#include "dseam/rt/arc_gate.hpp"
#include "dseam/rt/fault.hpp"
#include "dseam/trajectory/set_point.hpp"

namespace dseam::rt {

/// Looks at set points before any of them is sent. It never clamps: what breaks a hard limit is
/// not sent at all.
///
/// Speed, acceleration, jerk and turning are differences over the set points' own times, so that
/// the gate shares no code with the planner that it watches.
///
/// Context: check() O(1); check_all() where a trajectory is accepted, O(points).
class MotionGate {
 public:
  struct Config {
    Workspace workspace;
    double max_start_mm = 1.0;  ///< From where the torch is to the first set point,
    double max_start_rad = 0.05;
    double max_step_mm = 25.0;  ///< Between two set points,
    double max_step_rad = 0.2;
    double max_speed_mm_s = 500.0;
    double max_acceleration_mm_s2 = 3000.0;
    double max_jerk_mm_s3 = 60000.0;
    double max_turn_rad_s = 3.0;
  };
  struct Verdict {
    Fault fault = Fault::kNone;
    std::size_t index = 0;  ///< Of the first set point that is refused.
  };

  /// Errors:  kInvalidArgument: a limit that is not finite or not positive, an empty workspace.
  [[nodiscard]] static Result<MotionGate> make(const Config& config) noexcept;

  /// Begins anew at the place where the torch is at rest.
  void restart(const torch::TorchPose& now) noexcept;
  /// The next set point in order; kNone lets it pass.
  [[nodiscard]] DSEAM_NONBLOCKING Fault check(const trajectory::SetPoint& point) noexcept;
  /// A whole trajectory from rest at `now` to rest: at its end it must be able to stand still.
  [[nodiscard]] Verdict check_all(const torch::TorchPose& now,
                                  trajectory::SetPointView points) noexcept;

 private:
  explicit MotionGate(const Config& config) noexcept : config_(config) {}
  [[nodiscard]] Fault check_start(const trajectory::SetPoint& point) const noexcept;
  [[nodiscard]] Fault check_step(const trajectory::SetPoint& point) noexcept;
  [[nodiscard]] bool can_stand_at(const trajectory::SetPoint& last, std::uint32_t step_us) noexcept;

  Config config_;
  torch::TorchPose last_;
  std::uint32_t last_us_ = 0;
  Eigen::Vector3d velocity_mm_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_mm_s2_ = Eigen::Vector3d::Zero();
  std::size_t seen_ = 0;
};

}  // namespace dseam::rt
