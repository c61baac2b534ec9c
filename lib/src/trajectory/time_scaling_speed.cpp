// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "dseam/trajectory/time_scaling.hpp"

namespace dseam::trajectory {
namespace {

constexpr int kHalvings = 40;

}  // namespace

/// The smoothed torch is where the unsmoothed one is within a window of it; a slow place must
/// therefore slow down all that the window can reach from it.
void TimeScaling::erode(std::span<Cell> cells, double acceleration_mm_s2) const noexcept {
  const auto reach_of = [&](const Cell& cell) {
    return window_s_ * (cell.max_v_mm_s + acceleration_mm_s2 * window_s_);
  };
  for (std::size_t k = 0; k < cells.size(); ++k) {
    cells[k].v_mm_s = cells[k].max_v_mm_s;
  }
  const auto spread = [&](std::size_t from, auto next) {
    const double v = cells[from].max_v_mm_s;
    double left = reach_of(cells[from]);
    for (std::size_t k = next(from); k < cells.size() && left > 0.0; k = next(k)) {
      // What is as slow and reaches as far will do the rest.
      if (cells[k].max_v_mm_s <= v && reach_of(cells[k]) >= left) {
        return;
      }
      cells[k].v_mm_s = std::min(cells[k].v_mm_s, v);
      left -= cells[k].length_mm;
    }
  };
  for (std::size_t k = 0; k < cells.size(); ++k) {
    spread(k, [](std::size_t i) { return i + 1; });
    spread(k, [](std::size_t i) { return i - 1; });  // Before 0 lies the greatest number.
  }
  for (std::size_t k = 0; k < cells.size(); ++k) {
    Cell& cell = cells[k];
    if (cell.v_mm_s < cell.max_v_mm_s && cell.limited_by == LimitKind::kNone) {
      cell.limited_by = LimitKind::kRamp;
    }
    cell.max_v_mm_s = cell.v_mm_s;
  }
}

/// From rest to rest: forward no faster than the acceleration allows, then backward.
void TimeScaling::ramp(std::span<Cell> cells, double acceleration_mm_s2) noexcept {
  const double twice_a = 2.0 * acceleration_mm_s2;
  double v = 0.0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    Cell& cell = cells[k];
    cell.v_mm_s = std::min(v, cell.max_v_mm_s);
    v = std::min(cell.max_v_mm_s, std::sqrt(cell.v_mm_s * cell.v_mm_s + twice_a * cell.length_mm));
  }
  v = 0.0;
  for (std::size_t k = cells.size(); k-- > 0;) {
    Cell& cell = cells[k];
    v = std::min(cell.v_mm_s, std::sqrt(v * v + twice_a * cell.length_mm));
    cell.v_mm_s = v;
  }
}

/// Between speeding up and slowing down lies at least a window at even speed, as between slowing
/// down and speeding up after erode(). So the acceleration never goes from one end of its range to
/// the other within a window, and the jerk is A over the window rather than twice that.
void TimeScaling::hold_peaks(std::span<Cell> cells) const noexcept {
  const auto v = [&](std::size_t k) { return k < cells.size() ? cells[k].v_mm_s : 0.0; };
  for (std::size_t valley = 0; valley < cells.size();) {
    std::size_t top = valley;
    while (top < cells.size() && v(top + 1) >= v(top)) {
      ++top;
    }
    std::size_t next = top;
    while (next < cells.size() && v(next + 1) <= v(next)) {
      ++next;
    }
    hold_peak(cells.subspan(valley, next - valley), v(next), v(top));
    valley = next;
  }
}

/// `cells` rise to `top_mm_s` and fall to `end_mm_s`. Cuts their top off where it is too sharp.
void TimeScaling::hold_peak(std::span<Cell> cells, double end_mm_s,
                            double top_mm_s) const noexcept {
  const auto held_s = [&](double level_mm_s) {
    double sum_mm = 0.0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double next = k + 1 < cells.size() ? cells[k + 1].v_mm_s : end_mm_s;
      sum_mm += std::min(cells[k].v_mm_s, next) >= level_mm_s ? cells[k].length_mm : 0.0;
    }
    return sum_mm / level_mm_s;
  };
  if (held_s(top_mm_s) >= window_s_) {
    return;
  }
  double low = std::max(cells.front().v_mm_s, end_mm_s);
  double high = top_mm_s;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (held_s(middle) >= window_s_ ? low : high) = middle;
  }
  for (Cell& cell : cells) {
    cell.v_mm_s = std::min(cell.v_mm_s, low);
  }
}

}  // namespace dseam::trajectory
