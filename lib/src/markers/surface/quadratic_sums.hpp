// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>

#include "dseam/base/lanes.hpp"
#include "markers/surface/ring_surface.hpp"

namespace dseam::markers {

/// q . (1, x, y, x^2, x y, y^2) of eight places.
class QuadraticLanes {
 public:
  explicit QuadraticLanes(const Vector6& q) noexcept : q_(q.cast<float>()) {}
  [[gnu::always_inline, nodiscard]] lanes::FloatLanes at(
      const lanes::FloatLanes& x, const lanes::FloatLanes& y) const noexcept {
    using lanes::splat;
    return splat(q_(0)) + x * (splat(q_(1)) + splat(q_(3)) * x + splat(q_(4)) * y) +
           y * (splat(q_(2)) + splat(q_(5)) * y);
  }

 private:
  Eigen::Matrix<float, 6, 1> q_;
};

/// Normal equations of f = q . (1, x, y, x^2, x y, y^2) by least squares, eight places at a time:
/// of their 36 entries only 15 differ.
class QuadraticSums {
 public:
  /// Those whose mask is set.
  [[gnu::always_inline]] void add(const lanes::FloatLanes& all_x, const lanes::FloatLanes& all_y,
                                  const lanes::FloatLanes& all_f,
                                  const lanes::IntLanes& used) noexcept {
    const lanes::FloatLanes one = lanes::keep(used, lanes::splat(1.0F));
    const lanes::FloatLanes x = lanes::keep(used, all_x);
    const lanes::FloatLanes y = lanes::keep(used, all_y);
    const lanes::FloatLanes f = lanes::keep(used, all_f);
    const lanes::FloatLanes xx = x * x;
    const lanes::FloatLanes xy = x * y;
    const lanes::FloatLanes yy = y * y;
    const lanes::FloatLanes terms[kMoments] = {one,     x,       y,       xx,      xy,
                                               yy,      xx * x,  xx * y,  x * yy,  yy * y,
                                               xx * xx, xx * xy, xx * yy, xy * yy, yy * yy};
    for (std::size_t i = 0; i < kMoments; ++i) {
      moments_[i] = moments_[i] + terms[i];
    }
    for (std::size_t i = 0; i < kTerms; ++i) {
      right_[i] = right_[i] + f * terms[i];
    }
    squares_ = squares_ + f * f;
    count_ += static_cast<std::size_t>(std::popcount(lanes::bits(used)));
  }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Mean of the squares of f.
  [[nodiscard]] double mean_square() const noexcept {
    return sum(squares_) / static_cast<double>(count_);
  }
  [[nodiscard]] Vector6 solve() const noexcept {
    constexpr std::size_t kMomentOf[kTerms][kTerms] = {
        {0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},    {2, 4, 5, 7, 8, 9},
        {3, 6, 7, 10, 11, 12}, {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
    Eigen::Matrix<double, 6, 6> h;
    Vector6 g;
    for (std::size_t i = 0; i < kTerms; ++i) {
      g(static_cast<Eigen::Index>(i)) = sum(right_[i]);
      for (std::size_t j = 0; j < kTerms; ++j) {
        h(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            sum(moments_[kMomentOf[i][j]]);
      }
    }
    return h.ldlt().solve(g);
  }

 private:
  static constexpr std::size_t kMoments = 15;
  static constexpr std::size_t kTerms = 6;
  [[nodiscard]] static double sum(const lanes::FloatLanes& a) noexcept {
    double total = 0.0;
    for (std::size_t i = 0; i < lanes::kLanes; ++i) {
      total += static_cast<double>(a[i]);
    }
    return total;
  }

  lanes::FloatLanes moments_[kMoments] = {};
  lanes::FloatLanes right_[kTerms] = {};
  lanes::FloatLanes squares_ = {};
  std::size_t count_ = 0;
};

}  // namespace dseam::markers
