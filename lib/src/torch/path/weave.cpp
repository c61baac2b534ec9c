// SPDX-License-Identifier: Apache-2.0
#include "dseam/torch/weave.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dseam::torch {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMinMovingShare = 0.2;  // Of a period; the rest may be dwells.

/// The phase in [0, 1) of the motion alone: it stands still during the dwells, which lie at its
/// quarter (left) and three-quarter (right).
double moving_phase(const Weave& w, double s_mm) noexcept {
  const double moving_mm = w.pitch_mm - w.dwell_left_mm - w.dwell_right_mm;
  double x = s_mm - w.pitch_mm * std::floor(s_mm / w.pitch_mm);
  const double left_mm = 0.25 * moving_mm;
  const double right_mm = 0.75 * moving_mm;
  x = x <= left_mm ? x : std::max(left_mm, x - w.dwell_left_mm);
  x = x <= right_mm ? x : std::max(right_mm, x - w.dwell_right_mm);
  return x / moving_mm;
}

/// From 0 up to 1 at a quarter, down to -1 at three quarters, and back.
double saw(double phase) noexcept {
  if (phase < 0.25) {
    return 4.0 * phase;
  }
  return phase < 0.75 ? 2.0 - 4.0 * phase : 4.0 * phase - 4.0;
}

}  // namespace

bool is_valid(const Weave& w) noexcept {
  if (w.shape == WeaveShape::kNone) {
    return true;
  }
  const double dwell_mm = w.dwell_left_mm + w.dwell_right_mm;
  return w.shape <= WeaveShape::kCircle && w.amplitude_mm >= 0.0 && w.amplitude_mm <= 50.0 &&
         w.pitch_mm >= 0.1 && w.pitch_mm <= 1000.0 && w.dwell_left_mm >= 0.0 &&
         w.dwell_right_mm >= 0.0 && dwell_mm <= (1.0 - kMinMovingShare) * w.pitch_mm &&
         std::abs(w.height_mm) <= 50.0;
}

WeaveOffset offset_at(const Weave& w, double s_mm) noexcept {
  if (w.shape == WeaveShape::kNone) {
    return {};
  }
  const double phase = moving_phase(w, s_mm);
  switch (w.shape) {
    case WeaveShape::kZigZag:
      return {w.amplitude_mm * saw(phase), 0.0, 0.0};
    case WeaveShape::kTriangle:
      // Left, right, and between the two over the height: highest where it crosses the middle.
      return {w.amplitude_mm * saw(phase), w.height_mm * (1.0 - std::abs(saw(phase))), 0.0};
    case WeaveShape::kCircle:
      return {w.amplitude_mm * std::sin(kTurn * phase), 0.0,
              w.amplitude_mm * (1.0 - std::cos(kTurn * phase))};
    default:
      return {w.amplitude_mm * std::sin(kTurn * phase), 0.0, 0.0};
  }
}

double step_for(const Weave& w, double tolerance_mm) noexcept {
  if (w.shape == WeaveShape::kNone || w.amplitude_mm <= 0.0) {
    return 1e9;
  }
  // A spline over points h apart stays within h^2 / 6 of the second derivative.
  const double moving_mm = w.pitch_mm - w.dwell_left_mm - w.dwell_right_mm;
  const double wave = kTurn / moving_mm;
  return std::sqrt(6.0 * tolerance_mm / w.amplitude_mm) / wave;
}

Weave weave_from_times(WeaveShape shape, double amplitude_mm, double frequency_hz,
                       double dwell_left_s, double dwell_right_s, double speed_mm_s) noexcept {
  Weave w;
  w.shape = shape;
  w.amplitude_mm = amplitude_mm;
  w.dwell_left_mm = dwell_left_s * speed_mm_s;
  w.dwell_right_mm = dwell_right_s * speed_mm_s;
  w.pitch_mm = speed_mm_s / frequency_hz + w.dwell_left_mm + w.dwell_right_mm;
  return w;
}

}  // namespace dseam::torch
