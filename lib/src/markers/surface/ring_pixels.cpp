// SPDX-License-Identifier: Apache-2.0
#include "dseam/markers/ring_pixels.hpp"

#include <limits>

#include "markers/surface/image_window.hpp"

namespace dseam::markers {
namespace {

constexpr double kInnerRing = 1.25;
constexpr double kOuterRing = 2.5;

}  // namespace

void RingPixels::gather(const depth::DepthImage& frame, const geometry::Ellipse& rim,
                        double base_mm) noexcept {
  size_ = 0;
  base_mm_ = base_mm;
  const geometry::EllipseGauge gauge(rim);
  for_each_around(frame, rim, kOuterRing, [&](std::uint32_t u, std::uint32_t v) {
    const std::uint16_t count = frame.count_at(u, v);
    const double squared = gauge.squared_radius(u, v);
    if (count == 0 || size_ == kMaxPixels || squared < kInnerRing * kInnerRing ||
        squared > kOuterRing * kOuterRing) {
      return;
    }
    x_[size_] = static_cast<float>((u - rim.u) / rim.a);
    y_[size_] = static_cast<float>((v - rim.v) / rim.a);
    beyond_mm_[size_++] = static_cast<float>(count * frame.mm_per_count - base_mm);
  });
  for (std::size_t i = size_; i % lanes::kLanes != 0; ++i) {
    x_[i] = y_[i] = 0.0F;
    beyond_mm_[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace dseam::markers
