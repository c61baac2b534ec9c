// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dseam/geometry/symmetric_eigen3.hpp"
#include "dseam/search/query_cell.hpp"

namespace dseam::cloud {

/// Moments of the neighbours of eight points, each about its own point.
class CovarianceLanes {
 public:
  CovarianceLanes() noexcept {
    count_ = x_ = y_ = z_ = xx_ = xy_ = xz_ = yy_ = yz_ = zz_ = lanes::splat(0.0F);
  }

  /// The points of `cell` that lie within the squared limit of each of the eight.
  void add(const search::QueryCell& query, const search::Cell& cell,
           const lanes::FloatLanes& squared_limit) noexcept {
    using lanes::FloatLanes;
    using lanes::splat;
    for (std::size_t i = 0; i < lanes::kLanes; ++i) {
      const FloatLanes dx = splat(cell.x[i]) - query.x;
      const FloatLanes dy = splat(cell.y[i]) - query.y;
      const FloatLanes dz = splat(cell.z[i]) - query.z;
      const lanes::IntLanes near = dx * dx + dy * dy + dz * dz <= squared_limit;
      const FloatLanes kx = lanes::keep(near, dx);
      const FloatLanes ky = lanes::keep(near, dy);
      const FloatLanes kz = lanes::keep(near, dz);
      count_ = count_ + lanes::keep(near, splat(1.0F));
      x_ = x_ + kx;
      y_ = y_ + ky;
      z_ = z_ + kz;
      xx_ = xx_ + kx * kx;
      xy_ = xy_ + kx * ky;
      xz_ = xz_ + kx * kz;
      yy_ = yy_ + ky * ky;
      yz_ = yz_ + ky * kz;
      zz_ = zz_ + kz * kz;
    }
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
