// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace dseam::trajectory {

/// What the robot may do at its tool centre point.
struct Limits {
  double speed_mm_s = 250.0;
  double acceleration_mm_s2 = 1000.0;
  double jerk_mm_s3 = 20000.0;
  double angular_speed_rad_s = 1.5;
  double angular_acceleration_rad_s2 = 6.0;
};

/// All finite and greater than zero.
[[nodiscard]] bool is_valid(const Limits& limits) noexcept;

/// What holds the torch under the speed asked for, or kNone.
enum class LimitKind : std::uint8_t {
  kNone,
  kSpeed,
  kAcceleration,
  kJerk,
  kAngularSpeed,
  kAngularAcceleration,
  kRamp,  ///< It is on its way to or from a slower place or a stop.
};
inline constexpr std::size_t kNumLimitKinds = 7;

}  // namespace dseam::trajectory
