// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/symmetric_eigen3.hpp"

#include <initializer_list>

#include "vec3_lanes.hpp"

namespace dseam::geometry {
namespace {

using lanes::FloatLanes;
using lanes::IntLanes;
using lanes::splat;

// Far under any covariance of points a float can tell apart, far over what loses bits.
constexpr float kTiny = 1.0e-30F;

Symmetric3Lanes scaled(const Symmetric3Lanes& m, const FloatLanes& s) noexcept {
  return {m.xx * s, m.xy * s, m.xz * s, m.yy * s, m.yz * s, m.zz * s};
}

Vec3Lanes times(const Symmetric3Lanes& m, const Vec3Lanes& v) noexcept {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

FloatLanes determinant(const Symmetric3Lanes& m) noexcept {
  return m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) +
         m.xz * (m.xy * m.yz - m.yy * m.xz);
}

Symmetric3Lanes shifted(const Symmetric3Lanes& m, const FloatLanes& by) noexcept {
  return {m.xx - by, m.xy, m.xz, m.yy - by, m.yz, m.zz - by};
}

// The root of b^3 - 3 b - 2 a in [sqrt 3, 2] for a in [0, 1]; the secant is off by 0.01 at most.
FloatLanes separate_root(const FloatLanes& a) noexcept {
  FloatLanes b = splat(1.7320508F) + a * splat(0.2679492F);
  for (int step = 0; step < 3; ++step) {
    const FloatLanes b2 = b * b;
    b = b - (b * (b2 - splat(3.0F)) - splat(2.0F) * a) / (splat(3.0F) * (b2 - splat(1.0F)));
  }
  return b;
}

// The kernel of a matrix of rank two: the longest cross product of two of its rows.
Vec3Lanes kernel(const Symmetric3Lanes& m) noexcept {
  const Vec3Lanes x{m.xx, m.xy, m.xz};
  const Vec3Lanes y{m.xy, m.yy, m.yz};
  const Vec3Lanes z{m.xz, m.yz, m.zz};
  Vec3Lanes best = cross(x, y);
  for (const Vec3Lanes& other : {cross(x, z), cross(y, z)}) {
    best = select(dot(best, best) < dot(other, other), other, best);
  }
  return unit(best);
}

// Any unit vector across a unit vector; without the smaller of x and y it cannot vanish.
Vec3Lanes across(const Vec3Lanes& v) noexcept {
  const FloatLanes zero = splat(0.0F);
  const IntLanes x_is_less = lanes::magnitude(v.x) < lanes::magnitude(v.y);
  return unit(
      select(x_is_less, Vec3Lanes{zero, v.z, zero - v.y}, Vec3Lanes{zero - v.z, zero, v.x}));
}

// The two eigenvalues in the plane across `normal`, and the vector of the smaller.
struct InPlane {
  FloatLanes smaller;
  FloatLanes greater;
  Vec3Lanes axis;
};

InPlane solve_across(const Symmetric3Lanes& m, const Vec3Lanes& normal) noexcept {
  const Vec3Lanes u = across(normal);
  const Vec3Lanes w = cross(normal, u);
  const Vec3Lanes mu = times(m, u);
  const FloatLanes b = dot(w, mu);
  const FloatLanes uu = dot(u, mu);
  const FloatLanes ww = dot(w, times(m, w));
  const FloatLanes middle = splat(0.5F) * (uu + ww);
  const FloatLanes half = splat(0.5F) * (uu - ww);
  const FloatLanes radius = lanes::sqrt(half * half + b * b);
  const FloatLanes zero = splat(0.0F);
  // Of the two ways to write the vector the one without cancellation.
  const IntLanes u_is_greater = zero <= half;
  const FloatLanes cu = lanes::select(u_is_greater, zero - b, radius - half);
  const FloatLanes cw = lanes::select(u_is_greater, radius + half, zero - b);
  return {middle - radius, middle + radius, unit(sum(scaled(u, cu), scaled(w, cw)))};
}

}  // namespace

LeastAxisLanes least_axis(const Symmetric3Lanes& matrix) noexcept {
  const FloatLanes trace = matrix.xx + matrix.yy + matrix.zz;
  const FloatLanes scale = lanes::max(trace, splat(kTiny));
  const Symmetric3Lanes m = scaled(matrix, splat(1.0F) / scale);
  const FloatLanes mean = (m.xx + m.yy + m.zz) * splat(1.0F / 3.0F);
  const Symmetric3Lanes off = shifted(m, mean);
  const FloatLanes squares = off.xx * off.xx + off.yy * off.yy + off.zz * off.zz +
                             splat(2.0F) * (off.xy * off.xy + off.xz * off.xz + off.yz * off.yz);
  const FloatLanes spread = lanes::sqrt(squares * splat(1.0F / 6.0F));
  const FloatLanes safe = lanes::max(spread, splat(1.0e-12F));
  const FloatLanes half_det = splat(0.5F) * determinant(scaled(off, splat(1.0F) / safe));
  const FloatLanes root = separate_root(lanes::min(lanes::magnitude(half_det), splat(1.0F)));
  const IntLanes apart_is_most = splat(0.0F) <= half_det;
  const FloatLanes signed_root = lanes::select(apart_is_most, root, splat(0.0F) - root);
  const FloatLanes apart = mean + spread * signed_root;
  const Vec3Lanes apart_axis = kernel(shifted(m, apart));
  const InPlane rest = solve_across(m, apart_axis);
  return {lanes::select(apart_is_most, rest.smaller, apart) * scale,
          lanes::select(apart_is_most, rest.greater, rest.smaller) * scale,
          lanes::select(apart_is_most, apart, rest.greater) * scale,
          select(apart_is_most, rest.axis, apart_axis)};
}

}  // namespace dseam::geometry
