// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam::torch {

enum class WeaveShape : std::uint8_t { kNone, kSine, kZigZag, kTriangle, kCircle };

/// A periodic sideways motion over the centre line, a function of arc length alone: whatever stops
/// and goes on again goes on in phase.
///
/// Units:   mm along the centre line; dwells are lengths of travel held at the side.
struct Weave {
  WeaveShape shape = WeaveShape::kNone;
  double amplitude_mm = 0.0;  ///< To each side.
  double pitch_mm = 0.0;      ///< Travel of one period, dwells included.
  double dwell_left_mm = 0.0;
  double dwell_right_mm = 0.0;
  double height_mm = 0.0;  ///< kTriangle: how far outward it crosses the middle.
};

/// Sideways (along torch +y), outward (along torch -z) and, for the circle, along travel.
struct WeaveOffset {
  double across_mm = 0.0;
  double out_mm = 0.0;
  double along_mm = 0.0;
};

/// True when the shape is kNone or all lengths are finite, positive where they must be, and the
/// dwells leave room for the motion.
[[nodiscard]] bool is_valid(const Weave& weave) noexcept;
[[nodiscard]] WeaveOffset offset_at(const Weave& weave, double s_mm) noexcept;
/// The step at which a spline over the woven points keeps within `tolerance_mm` of a smooth
/// weave; corners are rounded within the same step.
[[nodiscard]] double step_for(const Weave& weave, double tolerance_mm) noexcept;

/// Pitch and dwells of a weave given in hertz (of its motion, dwells apart) and seconds.
[[nodiscard]] Weave weave_from_times(WeaveShape shape, double amplitude_mm, double frequency_hz,
                                     double dwell_left_s, double dwell_right_s,
                                     double speed_mm_s) noexcept;

}  // namespace dseam::torch
