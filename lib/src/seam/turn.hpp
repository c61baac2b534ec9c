// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/base/lanes.hpp"

/// Angles by polynomials: the same bits everywhere, which no mathematics library promises.
namespace dseam::seam {

inline constexpr float kQuarterTurn = 1.57079633F;
inline constexpr float kHalfTurn = 3.14159265F;
inline constexpr float kFullTurn = 6.28318531F;

/// For t in [-1, 1], within 1.5e-7.
[[nodiscard]] inline lanes::FloatLanes arc_tangent(const lanes::FloatLanes& t) noexcept {
  using lanes::splat;
  constexpr float kOdd[] = {-0.0559122786F, 0.0964219347F, -0.139086276F,
                            0.199465647F,   -0.333298594F, 0.999999344F};
  const lanes::FloatLanes t2 = t * t;
  lanes::FloatLanes sum = splat(-0.00405455846F) * t2 + splat(0.021862926F);
  for (const float coefficient : kOdd) {
    sum = sum * t2 + splat(coefficient);
  }
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

struct CosineSine {
  float cosine;
  float sine;
};

/// For an angle in [0, 4 pi], within 1e-6.
[[nodiscard]] inline CosineSine cosine_sine(float turn_rad) noexcept {
  const auto quarter = static_cast<int>(turn_rad * (1.0F / kQuarterTurn) + 0.5F);
  const float t = turn_rad - static_cast<float>(quarter) * kQuarterTurn;
  const float t2 = t * t;
  const float s = t + t * t2 * (-0.166666502F + t2 * (0.00833195798F + t2 * -0.000194934967F));
  const float c =
      1.0F - 0.5F * t2 + t2 * t2 * (0.0416666462F + t2 * (-0.00138873415F + t2 * 0.0000244358517F));
  const bool across = quarter % 2 == 1;
  const float cosine = across ? s : c;
  const float sine = across ? c : s;
  return {(quarter + 1) % 4 < 2 ? cosine : -cosine, quarter % 4 < 2 ? sine : -sine};
}

}  // namespace dseam::seam
