// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "dseam/base/lanes.hpp"
#include "dseam/cloud/crop_box.hpp"

namespace dseam::cloud {

/// Three rows of a transform applied to eight points.
[[nodiscard]] inline lanes::FloatLanes transformed(geometry::Vec3f row, float shift,
                                                   const lanes::FloatLanes& x,
                                                   const lanes::FloatLanes& y,
                                                   const lanes::FloatLanes& z) noexcept {
  using lanes::splat;
  return x * splat(row.x) + y * splat(row.y) + z * splat(row.z) + splat(shift);
}

[[nodiscard]] inline lanes::IntLanes are_finite(const lanes::FloatLanes& x,
                                                const lanes::FloatLanes& y,
                                                const lanes::FloatLanes& z) noexcept {
  const lanes::FloatLanes infinity = lanes::splat(std::numeric_limits<float>::infinity());
  return (lanes::magnitude(x) < infinity) & (lanes::magnitude(y) < infinity) &
         (lanes::magnitude(z) < infinity);
}

/// The test of eight points against a box.
class BoxLanes {
 public:
  explicit BoxLanes(const OrientedBox& box) noexcept : box_(box), aligned_(box.is_aligned()) {}

  [[nodiscard]] lanes::IntLanes contains(const lanes::FloatLanes& x, const lanes::FloatLanes& y,
                                         const lanes::FloatLanes& z) const noexcept {
    if (aligned_) {
      return between(x, y, z);
    }
    const geometry::Transform3f& t = box_.T_box_cloud;
    return between(transformed(t.row_x, t.translation_mm.x, x, y, z),
                   transformed(t.row_y, t.translation_mm.y, x, y, z),
                   transformed(t.row_z, t.translation_mm.z, x, y, z));
  }

 private:
  [[nodiscard]] lanes::IntLanes between(const lanes::FloatLanes& x, const lanes::FloatLanes& y,
                                        const lanes::FloatLanes& z) const noexcept {
    using lanes::splat;
    return (splat(box_.low_mm.x) <= x) & (x <= splat(box_.high_mm.x)) &
           (splat(box_.low_mm.y) <= y) & (y <= splat(box_.high_mm.y)) &
           (splat(box_.low_mm.z) <= z) & (z <= splat(box_.high_mm.z));
  }

  OrientedBox box_;
  bool aligned_;
};

}  // namespace dseam::cloud
