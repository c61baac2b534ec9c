// SPDX-License-Identifier: Apache-2.0
// What may be asked for where the path has the derivatives p', p'', p''' by its length:
// a = p'' v^2 + p' A and j = p''' v^3 + 3 p'' v A + p' J. The speed v takes a share of each limit
// at most; the ramps get all that it leaves.
#include <algorithm>
#include <cmath>

#include "dseam/trajectory/time_scaling.hpp"

namespace dseam::trajectory {
namespace {

constexpr double kBendShare = 0.5;      // of the acceleration: p'' v^2
constexpr double kJerkThird = 1.0 / 6;  // of the jerk: p''' v^3
constexpr double kJerkCross = 0.5;      // 3 p'' v A
constexpr double kJerkAlong = 1.0 - kJerkThird - kJerkCross;

void lower(double bound_mm_s, LimitKind kind, double& v_mm_s, LimitKind& limited_by) noexcept {
  if (bound_mm_s < v_mm_s) {  // Infinite, and false, where nothing bends or turns.
    v_mm_s = bound_mm_s;
    limited_by = kind;
  }
}

}  // namespace

void TimeScaling::bound_speed(double asked_mm_s, Cell& cell) const noexcept {
  const PathRates& r = cell.rates;
  const double alpha = limits_.angular_acceleration_rad_s2;
  cell.max_v_mm_s = asked_mm_s;
  cell.limited_by = LimitKind::kNone;
  const auto bound = [&](LimitKind kind, double v_mm_s) {
    lower(v_mm_s, kind, cell.max_v_mm_s, cell.limited_by);
  };
  bound(LimitKind::kSpeed, limits_.speed_mm_s / r.tangent);
  bound(LimitKind::kAcceleration, std::sqrt(kBendShare * limits_.acceleration_mm_s2 / r.curvature));
  bound(LimitKind::kJerk, std::cbrt(kJerkThird * limits_.jerk_mm_s3 / r.third));
  bound(LimitKind::kAngularSpeed, limits_.angular_speed_rad_s / r.turn);
  bound(LimitKind::kAngularAcceleration, std::sqrt(kBendShare * alpha / r.turn_rate));
}

/// The greatest change of speed for the whole path, and the window over which it sets in: wide
/// enough for the jerk wherever the path bends most. No greater than reaching the highest speed
/// needs, and at least what the shares warrant, even if bends must then be taken more slowly.
void TimeScaling::choose_acceleration() noexcept {
  const double a = limits_.acceleration_mm_s2;
  const double j = limits_.jerk_mm_s3;
  double tangent = 1.0;
  double speed = 0.0;
  double spare = a;
  for (const Cell& cell : cells_.first(num_cells_)) {
    const PathRates& r = cell.rates;
    const double v = cell.max_v_mm_s;
    tangent = std::max(tangent, r.tangent);
    speed = std::max(speed, v);
    spare = std::min(
        {spare, (a - r.curvature * v * v) / r.tangent, kJerkCross * j / (3.0 * r.curvature * v)});
  }
  const double least =
      std::min((1.0 - kBendShare) * a / tangent, std::sqrt(0.5 * speed * kJerkAlong * j / tangent));
  double chosen = std::max(spare, least);
  for (Cell& cell : cells_.first(num_cells_)) {
    lower(kJerkCross * j / (3.0 * cell.rates.curvature * chosen), LimitKind::kJerk, cell.max_v_mm_s,
          cell.limited_by);
  }
  chosen = std::min(chosen, std::sqrt(speed * jerk_beside(chosen)));
  max_acceleration_mm_s2_ = chosen;
  window_s_ = chosen / jerk_beside(chosen);
}

/// What the bends leave of the jerk for the ramps where speed changes by `acceleration_mm_s2`.
double TimeScaling::jerk_beside(double acceleration_mm_s2) const noexcept {
  double least = limits_.jerk_mm_s3;
  for (const Cell& cell : cells_.first(num_cells_)) {
    const PathRates& r = cell.rates;
    const double v = cell.max_v_mm_s;
    const double bend = v * (r.third * v * v + 3.0 * r.curvature * acceleration_mm_s2);
    least = std::min(least, (limits_.jerk_mm_s3 - bend) / r.tangent);
  }
  return least;
}

/// The turns of a stretch may allow less than the whole path does.
double TimeScaling::acceleration_on(std::span<const Cell> cells) const noexcept {
  double least = max_acceleration_mm_s2_;
  for (const Cell& cell : cells) {
    const double v = cell.max_v_mm_s;
    const double spare = limits_.angular_acceleration_rad_s2 - cell.rates.turn_rate * v * v;
    least = std::min(least, spare / cell.rates.turn);
  }
  return least;
}

}  // namespace dseam::trajectory
