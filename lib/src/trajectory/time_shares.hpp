// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dseam::trajectory {

// How acceleration and jerk are shared between the path's bends and the change of speed along it:
// a = p'' v^2 + p' A and j = p''' v^3 + 3 p'' v A + p' J.
inline constexpr double kBendShare = 0.5;      // of the acceleration: p'' v^2
inline constexpr double kAlongShare = 0.5;     // p' A
inline constexpr double kJerkThird = 1.0 / 6;  // of the jerk: p''' v^3
inline constexpr double kJerkCross = 0.5;      // 3 p'' v A
inline constexpr double kJerkAlong = 1.0 / 3;  // p' J

}  // namespace dseam::trajectory
