// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/geometry/symmetric_eigen3.hpp"
#include "dseam/search/near_points.hpp"
#include "dseam/search/query_cell.hpp"

namespace dseam::cloud {

/// Moments of the neighbours of eight points, each about its own point.
class CovarianceLanes {
 public:
  CovarianceLanes() noexcept {
    count_ = x_ = y_ = z_ = xx_ = xy_ = xz_ = yy_ = yz_ = zz_ = lanes::splat(0.0F);
  }

  /// Those of `points` that lie within the squared limit of each of the eight.
  void add(const search::QueryCell& eight, const search::NearView& points,
           const lanes::FloatLanes& squared_limit) noexcept {
    using lanes::FloatLanes;
    using lanes::splat;
    const search::QueryCell query = eight;
    CovarianceLanes sums = *this;  // In registers, as far as they go.
    for (std::size_t i = 0; i < points.count; ++i) {
      const FloatLanes dx = splat(points.x[i]) - query.x;
      const FloatLanes dy = splat(points.y[i]) - query.y;
      const FloatLanes dz = splat(points.z[i]) - query.z;
      const lanes::IntLanes near = dx * dx + dy * dy + dz * dz <= squared_limit;
      const FloatLanes kx = lanes::keep(near, dx);
      const FloatLanes ky = lanes::keep(near, dy);
      const FloatLanes kz = lanes::keep(near, dz);
      sums.count_ = sums.count_ + lanes::keep(near, splat(1.0F));
      sums.x_ = sums.x_ + kx;
      sums.y_ = sums.y_ + ky;
      sums.z_ = sums.z_ + kz;
      sums.xx_ = sums.xx_ + kx * kx;
      sums.xy_ = sums.xy_ + kx * ky;
      sums.xz_ = sums.xz_ + kx * kz;
      sums.yy_ = sums.yy_ + ky * ky;
      sums.yz_ = sums.yz_ + ky * kz;
      sums.zz_ = sums.zz_ + kz * kz;
    }
    *this = sums;
  }

  [[nodiscard]] const lanes::FloatLanes& count() const noexcept { return count_; }
  [[nodiscard]] geometry::Symmetric3Lanes covariance() const noexcept {
    const lanes::FloatLanes share = lanes::splat(1.0F) / count_;
    const lanes::FloatLanes mx = x_ * share;
    const lanes::FloatLanes my = y_ * share;
    const lanes::FloatLanes mz = z_ * share;
    return {xx_ * share - mx * mx, xy_ * share - mx * my, xz_ * share - mx * mz,
            yy_ * share - my * my, yz_ * share - my * mz, zz_ * share - mz * mz};
  }

 private:
  lanes::FloatLanes count_, x_, y_, z_, xx_, xy_, xz_, yy_, yz_, zz_;
};

}  // namespace dseam::cloud
