// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "dseam/base/expects.hpp"
#include "dseam/base/result.hpp"
#include "dseam/hal/can_bus.hpp"
#include "dseam/rt/fault.hpp"
#include "dseam/seam/seam_curve.hpp"

namespace dseam::rt {

/// The box that the torch may not leave.
///
/// Frame:   base.
struct Workspace {
  Eigen::Vector3d low_mm = Eigen::Vector3d::Constant(-3000.0);
  Eigen::Vector3d high_mm = Eigen::Vector3d::Constant(3000.0);

  /// NaN lies outside.
  [[nodiscard]] bool contains(const Eigen::Vector3d& p_base) const noexcept {
    return (p_base.array() >= low_mm.array()).all() && (p_base.array() <= high_mm.array()).all();
  }
};

/// What the arc gate looks at, taken in one cycle.
struct ArcInputs {
  bool armed = false;
  std::int64_t data_age_ns = 0;  ///< Of the newest valid status from the robot,
  std::int64_t pose_age_ns = 0;  ///< and of the newest pose.
  seam::Confidence confidence = seam::Confidence::kNone;  ///< Of the seam under the torch.
  std::int64_t stream_age_ns = 0;  ///< Since the robot last got further along the set points.
  hal::BusState bus = hal::BusState::kDown;
  double tracking_mm = 0.0;       ///< From the torch to where it was sent.
  double speed_mm_s = 0.0;        ///< Of the torch,
  double planned_low_mm_s = 0.0;  ///< and what was planned around here.
  double planned_high_mm_s = 0.0;
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  double corridor_mm = 0.0;  ///< From the torch to the nearest place on the planned path.
  bool overrun = false;
  std::int64_t standing_ns = 0;  ///< How long the torch has stayed in one place with the arc on.
};

/// Decides in each cycle whether the arc may burn: only while all conditions hold. Stateless; the
/// session latches what it says.
///
/// Context: the cycle; no branch depends on what it cost before.
class ArcGate {
 public:
  struct Config {
    std::int64_t max_data_age_ns = 20'000'000;
    std::int64_t max_pose_age_ns = 60'000'000;
    seam::Confidence min_confidence = seam::Confidence::kLow;
    std::int64_t max_stream_age_ns = 100'000'000;
    double max_tracking_mm = 5.0;
    double speed_tolerance_mm_s = 5.0;   ///< Around the planned speed,
    double speed_tolerance_share = 0.3;  ///< or this share of it, whichever is more.
    Workspace workspace;
    double max_corridor_mm = 2.0;
    std::int64_t max_standing_ns = 1'500'000'000;
  };
  /// Errors:  kInvalidArgument: a limit that is not finite or not positive, an empty workspace.
  [[nodiscard]] static Result<ArcGate> make(const Config& config) noexcept;

  /// kNone: the arc may burn. Otherwise the first condition that is lost, in the order of Fault.
  [[nodiscard]] DSEAM_NONBLOCKING Fault check(const ArcInputs& in) const noexcept;

 private:
  explicit ArcGate(const Config& config) noexcept : config_(config) {}
  [[nodiscard]] bool speed_is_right(const ArcInputs& in) const noexcept;
  Config config_;
};

}  // namespace dseam::rt
