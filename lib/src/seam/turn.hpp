// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/base/lanes.hpp"

/// Angles by polynomials: the same bits everywhere, which no mathematics library promises.
namespace dseam::seam {

inline constexpr float kQuarterTurn = 1.57079633F;
inline constexpr float kHalfTurn = 3.14159265F;
inline constexpr float kFullTurn = 6.28318531F;

/// For t in [-1, 1], within 1.5e-7. Written out: a loop over the coefficients is not unrolled.
[[nodiscard]] inline lanes::FloatLanes arc_tangent(const lanes::FloatLanes& t) noexcept {
  using lanes::splat;
  const lanes::FloatLanes t2 = t * t;
  lanes::FloatLanes sum = splat(-0.00405455846F) * t2 + splat(0.021862926F);
  sum = sum * t2 + splat(-0.0559122786F);
  sum = sum * t2 + splat(0.0964219347F);
  sum = sum * t2 + splat(-0.139086276F);
  sum = sum * t2 + splat(0.199465647F);
  sum = sum * t2 + splat(-0.333298594F);
  sum = sum * t2 + splat(0.999999344F);
  return sum * t;
}

/// The angle of (a, b) from the a-axis in [0, 2 pi]; `sum` is |a| + |b|, not 0.
[[nodiscard]] inline lanes::FloatLanes turn_of(const lanes::FloatLanes& a,
                                               const lanes::FloatLanes& b,
                                               const lanes::FloatLanes& sum) noexcept {
  using lanes::splat;
  const lanes::FloatLanes zero = splat(0.0F);
  const lanes::FloatLanes slope = (lanes::magnitude(b) - lanes::magnitude(a)) / sum;
  const lanes::FloatLanes first = splat(0.5F * kQuarterTurn) + arc_tangent(slope);
  const lanes::FloatLanes upper = lanes::select(a < zero, splat(kHalfTurn) - first, first);
  return lanes::select(b < zero, splat(kFullTurn) - upper, upper);
}

struct CosineSineLanes {
  lanes::FloatLanes cosine;
  lanes::FloatLanes sine;
};

/// For angles in [0, 4 pi], within 1e-6.
[[nodiscard]] inline CosineSineLanes cosine_sine(const lanes::FloatLanes& turn_rad) noexcept {
  using lanes::FloatLanes;
  using lanes::IntLanes;
  using lanes::splat;
  const IntLanes quarter = lanes::to_int(turn_rad * splat(1.0F / kQuarterTurn) + splat(0.5F));
  const FloatLanes t = turn_rad - lanes::to_float(quarter) * splat(kQuarterTurn);
  const FloatLanes t2 = t * t;
  const FloatLanes s =
      t +
      t * t2 * (splat(-0.166666502F) + t2 * (splat(0.00833195798F) + t2 * splat(-0.000194934967F)));
  const FloatLanes c =
      splat(1.0F) - splat(0.5F) * t2 +
      t2 * t2 *
          (splat(0.0416666462F) + t2 * (splat(-0.00138873415F) + t2 * splat(0.0000244358517F)));
  const IntLanes is_even = (quarter & splat(1)) == splat(0);
  const FloatLanes cosine = lanes::select(is_even, c, s);
  const FloatLanes sine = lanes::select(is_even, s, c);
  const IntLanes is_right = ((quarter + splat(1)) & splat(2)) == splat(0);
  const IntLanes is_upper = (quarter & splat(2)) == splat(0);
  return {lanes::select(is_right, cosine, lanes::negated(cosine)),
          lanes::select(is_upper, sine, lanes::negated(sine))};
}

}  // namespace dseam::seam
