// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace dseam::geometry {

/// Three floats for the stages that must give the same bits everywhere. Eigen stays out of those:
/// it emits fused multiply-add by itself. Poses and fits use Eigen's fixed-size doubles.
struct Vec3f {
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;

  friend constexpr bool operator==(const Vec3f&, const Vec3f&) = default;
};

[[nodiscard]] constexpr Vec3f operator+(Vec3f a, Vec3f b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
[[nodiscard]] constexpr Vec3f operator-(Vec3f a, Vec3f b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] constexpr Vec3f operator-(Vec3f a) noexcept { return {-a.x, -a.y, -a.z}; }
[[nodiscard]] constexpr Vec3f operator*(Vec3f a, float s) noexcept {
  return {a.x * s, a.y * s, a.z * s};
}
[[nodiscard]] constexpr float dot(Vec3f a, Vec3f b) noexcept {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] constexpr Vec3f cross(Vec3f a, Vec3f b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] constexpr float squared_norm(Vec3f a) noexcept { return dot(a, a); }
[[nodiscard]] inline float norm(Vec3f a) noexcept { return std::sqrt(squared_norm(a)); }

}  // namespace dseam::geometry
