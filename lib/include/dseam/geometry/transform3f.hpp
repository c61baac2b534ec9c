// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/geometry/rigid_transform.hpp"
#include "dseam/geometry/vec3f.hpp"

namespace dseam::geometry {

/// A rigid transform as twelve floats, for the stages that must give the same bits everywhere.
struct Transform3f {
  Vec3f row_x{1.0F, 0.0F, 0.0F};
  Vec3f row_y{0.0F, 1.0F, 0.0F};
  Vec3f row_z{0.0F, 0.0F, 1.0F};
  Vec3f translation_mm;

  [[nodiscard]] constexpr Vec3f operator*(Vec3f p) const noexcept {
    return Vec3f{dot(row_x, p), dot(row_y, p), dot(row_z, p)} + translation_mm;
  }
  friend constexpr bool operator==(const Transform3f&, const Transform3f&) = default;
};

[[nodiscard]] inline Transform3f to_float(const RigidTransform& transform) noexcept {
  const auto row = [](double x, double y, double z) noexcept {
    return Vec3f{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  };
  const Eigen::Matrix3d& r = transform.rotation;
  const Eigen::Vector3d& t = transform.translation_mm;
  return {row(r(0, 0), r(0, 1), r(0, 2)), row(r(1, 0), r(1, 1), r(1, 2)),
          row(r(2, 0), r(2, 1), r(2, 2)), row(t.x(), t.y(), t.z())};
}

}  // namespace dseam::geometry
