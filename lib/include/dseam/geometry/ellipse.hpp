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
};

/// Asks one ellipse about many pixels.
class EllipseGauge {
 public:
  explicit EllipseGauge(const Ellipse& e) noexcept
      : u_(e.u),
        v_(e.v),
        along_u_(std::cos(e.angle_rad) / e.a),
        along_v_(std::sin(e.angle_rad) / e.a),
        across_u_(-std::sin(e.angle_rad) / e.b),
        across_v_(std::cos(e.angle_rad) / e.b) {}

  /// 0 at the centre, 1 on the ellipse.
  [[nodiscard]] double squared_radius(double pu, double pv) const noexcept {
    const double along = (pu - u_) * along_u_ + (pv - v_) * along_v_;
    const double across = (pu - u_) * across_u_ + (pv - v_) * across_v_;
    return along * along + across * across;
  }
  /// Its root.
  [[nodiscard]] double radius(double pu, double pv) const noexcept {
    return std::sqrt(squared_radius(pu, pv));
  }

 private:
  double u_, v_, along_u_, along_v_, across_u_, across_v_;
};

}  // namespace dseam::geometry
