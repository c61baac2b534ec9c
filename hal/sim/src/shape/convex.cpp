// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "dseam/hal/sim/solid.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

constexpr std::uint8_t kSide = 0;
constexpr std::uint8_t kLowCap = 1;
constexpr std::uint8_t kHighCap = 2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Crossing kEverywhere{-kInfinity, kInfinity, 0, 0};

void enter_later(Crossing& crossing, double t, std::uint8_t face) {
  if (t > crossing.enter) {
    crossing.enter = t;
    crossing.enter_face = face;
  }
}

void leave_sooner(Crossing& crossing, double t, std::uint8_t face) {
  if (t < crossing.leave) {
    crossing.leave = t;
    crossing.leave_face = face;
  }
}

/// Cuts the crossing down to low <= o + t d <= high.
void clip(Crossing& crossing, double o, double d, double low, double high, std::uint8_t low_face,
          std::uint8_t high_face) {
  if (d == 0.0) {
    crossing = o >= low && o <= high ? crossing : Crossing{};
    return;
  }
  const double to_low = (low - o) / d;
  const double to_high = (high - o) / d;
  enter_later(crossing, d > 0.0 ? to_low : to_high, d > 0.0 ? low_face : high_face);
  leave_sooner(crossing, d > 0.0 ? to_high : to_low, d > 0.0 ? high_face : low_face);
}

/// The roots of a t^2 + 2 b t + c, in order; b is halved so that no digit is lost to a factor.
struct Roots {
  bool real = false;
  double first = 0.0;
  double second = 0.0;
};

Roots roots_of(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0)) {
    return {};
  }
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double one = q / a;
  const double other = c / q;
  return {true, std::min(one, other), std::max(one, other)};
}

Crossing cross_tube_side(const Convex& tube, const Vector3d& o, const Vector3d& d) {
  const double ox = o.x() / tube.half.x();
  const double dx = d.x() / tube.half.x();
  const double oy = o.y() / tube.half.y();
  const double dy = d.y() / tube.half.y();
  const double oz = 1.0 + tube.taper * o.z();
  const double dz = tube.taper * d.z();
  const double a = dx * dx + dy * dy - dz * dz;
  const double b = ox * dx + oy * dy - oz * dz;
  const double c = ox * ox + oy * oy - oz * oz;
  if (a == 0.0 && b == 0.0) {  // Along the axis of a cylinder.
    return c < 0.0 ? kEverywhere : Crossing{};
  }
  const Roots roots = roots_of(a, b, c);
  if (!roots.real) {
    return {};
  }
  if (a > 0.0) {
    const bool on_this_nappe = oz + dz * 0.5 * (roots.first + roots.second) > 0.0;
    return on_this_nappe ? Crossing{roots.first, roots.second, kSide, kSide} : Crossing{};
  }
  return dz > 0.0 ? Crossing{roots.second, kInfinity, kSide, kSide}
                  : Crossing{-kInfinity, roots.first, kSide, kSide};
}

Crossing cross_ellipsoid(const Convex& body, const Vector3d& o, const Vector3d& d) {
  const Vector3d os = o.cwiseQuotient(body.half);
  const Vector3d ds = d.cwiseQuotient(body.half);
  const Roots roots = roots_of(ds.squaredNorm(), os.dot(ds), os.squaredNorm() - 1.0);
  return roots.real ? Crossing{roots.first, roots.second, kSide, kSide} : Crossing{};
}

Crossing cross_box(const Convex& box, const Vector3d& o, const Vector3d& d) {
  Crossing crossing = kEverywhere;
  for (int axis = 0; axis < 3; ++axis) {
    const auto face = static_cast<std::uint8_t>(2 * axis);
    clip(crossing, o[axis], d[axis], -box.half[axis], box.half[axis], face,
         static_cast<std::uint8_t>(face + 1));
  }
  return crossing;
}

Vector3d tube_normal(const Convex& tube, const Vector3d& p, std::uint8_t face) {
  if (face != kSide) {
    return face == kLowCap ? Vector3d(0.0, 0.0, -1.0) : Vector3d(0.0, 0.0, 1.0);
  }
  return {p.x() / (tube.half.x() * tube.half.x()), p.y() / (tube.half.y() * tube.half.y()),
          -tube.taper * (1.0 + tube.taper * p.z())};
}

Vector3d box_normal(std::uint8_t face) {
  Vector3d normal = Vector3d::Zero();
  normal[face / 2] = face % 2 == 0 ? -1.0 : 1.0;
  return normal;
}

}  // namespace

Crossing Convex::cross(const Ray& ray) const noexcept {
  const Vector3d o = axes.transpose() * (ray.origin - centre);
  const Vector3d d = axes.transpose() * ray.direction;
  if (kind == Kind::kBox) {
    return cross_box(*this, o, d);
  }
  if (kind == Kind::kEllipsoid) {
    return cross_ellipsoid(*this, o, d);
  }
  Crossing crossing = cross_tube_side(*this, o, d);
  if (crossing.hits()) {
    clip(crossing, o.z(), d.z(), low, high, kLowCap, kHighCap);
  }
  return crossing;
}

Vector3d Convex::normal(const Vector3d& p, std::uint8_t face) const noexcept {
  const Vector3d local = axes.transpose() * (p - centre);
  const Vector3d n = kind == Kind::kBox         ? box_normal(face)
                     : kind == Kind::kEllipsoid ? Vector3d(local.cwiseQuotient(half.cwiseAbs2()))
                                                : tube_normal(*this, local, face);
  return (axes * n).normalized();
}

bool Convex::contains(const Vector3d& p) const noexcept {
  const Vector3d local = axes.transpose() * (p - centre);
  const Vector3d scaled = local.cwiseQuotient(half);
  if (kind == Kind::kBox) {
    return scaled.cwiseAbs().maxCoeff() <= 1.0;
  }
  if (kind == Kind::kEllipsoid) {
    return scaled.squaredNorm() <= 1.0;
  }
  const double width = 1.0 + taper * local.z();
  return width > 0.0 && scaled.head<2>().norm() <= width && local.z() >= low && local.z() <= high;
}

}  // namespace dseam::hal::sim
