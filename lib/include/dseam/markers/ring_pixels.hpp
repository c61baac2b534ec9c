// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "dseam/base/arena.hpp"
#include "dseam/base/lanes.hpp"
#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/ellipse.hpp"

namespace dseam::markers {

/// The depth of the ring beside a rim, gathered once for the fits that go through it many times.
///
/// Memory:  50 kB, lent.
/// Time:    a bounded number of pixels, whatever the size of the disc.
class RingPixels {
 public:
  /// Eight pixels; those past the last one have a depth that is not a number.
  struct Eight {
    lanes::FloatLanes x;          ///< From the rim's centre, in its long half axes; right.
    lanes::FloatLanes y;          ///< The same, down.
    lanes::FloatLanes beyond_mm;  ///< Depth beyond the base.
  };

  [[nodiscard]] static constexpr std::size_t bytes() noexcept {
    return 3 * Arena::bytes<float>(kMaxPixels);
  }
  RingPixels() = default;
  explicit RingPixels(Arena& arena) noexcept
      : x_(arena.take<float>(kMaxPixels)),
        y_(arena.take<float>(kMaxPixels)),
        beyond_mm_(arena.take<float>(kMaxPixels)) {}

  /// `base_mm` is a depth near the ring's: floats then hold what differs from it to a nanometre.
  void gather(const depth::DepthImage& frame, const geometry::Ellipse& rim,
              double base_mm) noexcept;

  [[nodiscard]] double base_mm() const noexcept { return base_mm_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  template <typename Call>
  [[gnu::always_inline]] void for_each_eight(const Call& call) const noexcept {
    for (std::size_t i = 0; i < size_; i += lanes::kLanes) {
      call(Eight{lanes::load(&x_[i]), lanes::load(&y_[i]), lanes::load(&beyond_mm_[i])});
    }
  }

 private:
  // Of a ring of 2.5 half axes of 16 pixels, beyond which only each n-th pixel is taken: 3,770.
  static constexpr std::size_t kMaxPixels = 4096;

  std::span<float> x_;
  std::span<float> y_;
  std::span<float> beyond_mm_;
  std::size_t size_ = 0;
  double base_mm_ = 0.0;
};

}  // namespace dseam::markers
