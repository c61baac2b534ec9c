// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/geometry/symmetric_eigen3.hpp"

namespace dseam::geometry {

[[nodiscard]] inline Vec3Lanes scaled(const Vec3Lanes& a, const lanes::FloatLanes& s) noexcept {
  return {a.x * s, a.y * s, a.z * s};
}
[[nodiscard]] inline Vec3Lanes sum(const Vec3Lanes& a, const Vec3Lanes& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] inline lanes::FloatLanes dot(const Vec3Lanes& a, const Vec3Lanes& b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3Lanes cross(const Vec3Lanes& a, const Vec3Lanes& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline Vec3Lanes select(const lanes::IntLanes& mask, const Vec3Lanes& a,
                                      const Vec3Lanes& b) noexcept {
  return {lanes::select(mask, a.x, b.x), lanes::select(mask, a.y, b.y),
          lanes::select(mask, a.z, b.z)};
}
[[nodiscard]] inline Vec3Lanes unit(const Vec3Lanes& a) noexcept {
  return scaled(a, lanes::splat(1.0F) / lanes::sqrt(dot(a, a)));
}

}  // namespace dseam::geometry
