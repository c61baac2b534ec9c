// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "dseam/trajectory/time_scaling.hpp"
#include "time_shares.hpp"

namespace dseam::trajectory {

void TimeScaling::bound_cell(double asked_mm_s, Cell& cell) const noexcept {
  const PathRates& r = cell.rates;
  const double a = limits_.acceleration_mm_s2;
  const double j = limits_.jerk_mm_s3;
  const struct {
    LimitKind kind;
    double v_mm_s;  // Infinite where nothing bends or turns; the comparison below fails then.
  } bounds[] = {
      {LimitKind::kSpeed, limits_.speed_mm_s / r.tangent},
      {LimitKind::kAcceleration, std::sqrt(kBendShare * a / r.curvature)},
      {LimitKind::kJerk, std::cbrt(kJerkThird * j / r.third)},
      {LimitKind::kJerk, kJerkCross * j / (3.0 * r.curvature * stretch_acceleration_mm_s2_)},
      {LimitKind::kAngularSpeed, limits_.angular_speed_rad_s / r.turn},
      {LimitKind::kAngularAcceleration,
       std::sqrt(kBendShare * limits_.angular_acceleration_rad_s2 / r.turn_rate)}};
  cell.max_v_mm_s = asked_mm_s;
  cell.limited_by = LimitKind::kNone;
  for (const auto& bound : bounds) {
    if (bound.v_mm_s < cell.max_v_mm_s) {
      cell.max_v_mm_s = bound.v_mm_s;
      cell.limited_by = bound.kind;
    }
  }
}

/// The smoothed torch is where the unsmoothed one is within a window of it; a slow place must
/// therefore slow down all that the window can reach from it.
void TimeScaling::erode() noexcept {
  const auto reach_of = [&](const Cell& cell) {
    return window_s_ * (cell.max_v_mm_s + stretch_acceleration_mm_s2_ * window_s_);
  };
  for (std::size_t k = 0; k < num_cells_; ++k) {
    cells_[k].v_mm_s = cells_[k].max_v_mm_s;
  }
  const auto spread = [&](std::size_t from, auto next) {
    const double v = cells_[from].max_v_mm_s;
    double left = reach_of(cells_[from]);
    for (std::size_t k = next(from); k < num_cells_ && left > 0.0; k = next(k)) {
      // What is as slow and reaches as far will do the rest.
      if (cells_[k].max_v_mm_s <= v && reach_of(cells_[k]) >= left) {
        return;
      }
      cells_[k].v_mm_s = std::min(cells_[k].v_mm_s, v);
      left -= cells_[k].length_mm;
    }
  };
  for (std::size_t k = 0; k < num_cells_; ++k) {
    spread(k, [](std::size_t i) { return i + 1; });
    spread(k, [](std::size_t i) { return i - 1; });  // Before 0 lies the greatest number.
  }
  for (std::size_t k = 0; k < num_cells_; ++k) {
    Cell& cell = cells_[k];
    if (cell.v_mm_s < cell.max_v_mm_s && cell.limited_by == LimitKind::kNone) {
      cell.limited_by = LimitKind::kRamp;
    }
    cell.max_v_mm_s = cell.v_mm_s;
  }
}

/// From rest to rest: forward no faster than the acceleration allows, then backward.
void TimeScaling::ramp() noexcept {
  const double twice_a = 2.0 * stretch_acceleration_mm_s2_;
  double v = 0.0;
  for (std::size_t k = 0; k < num_cells_; ++k) {
    Cell& cell = cells_[k];
    cell.v_mm_s = std::min(v, cell.max_v_mm_s);
    v = std::min(cell.max_v_mm_s, std::sqrt(cell.v_mm_s * cell.v_mm_s + twice_a * cell.length_mm));
  }
  v = 0.0;
  for (std::size_t k = num_cells_; k-- > 0;) {
    Cell& cell = cells_[k];
    const double end_v = v;
    v = std::min(cell.v_mm_s, std::sqrt(end_v * end_v + twice_a * cell.length_mm));
    cell.v_mm_s = v;
    const bool held_back = std::min(v, end_v) < cell.max_v_mm_s * (1.0 - 1e-9);
    if (held_back && cell.limited_by == LimitKind::kNone) {
      cell.limited_by = LimitKind::kRamp;
    }
  }
}

}  // namespace dseam::trajectory
