// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace dseam::geometry {

/// An ellipse in the image.
///
/// Units:   pixels; the angle is that of the long half axis `a` against +u.
struct Ellipse {
  double u = 0.0;
  double v = 0.0;
  double a = 0.0;
  double b = 0.0;
  double angle_rad = 0.0;

  /// 0 at the centre, 1 on the ellipse.
  [[nodiscard]] double relative_radius(double pu, double pv) const noexcept {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    const double along = (pu - u) * c + (pv - v) * s;
    const double across = (pv - v) * c - (pu - u) * s;
    return std::hypot(along / a, across / b);
  }
};

}  // namespace dseam::geometry
