// SPDX-License-Identifier: Apache-2.0
#include "pipeline/marker_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dseam::pipeline {
namespace {

constexpr double kCovered = 1.3;  // Of the ellipse's half axes; markers::Marker says why.

/// First and one past the last pixel of centre +- reach that the image has.
struct PixelRange {
  std::uint32_t first;
  std::uint32_t end;
};

PixelRange range_around(double centre, double reach, std::uint32_t size) noexcept {
  const double last = static_cast<double>(size);
  const double first = std::clamp(std::floor(centre - reach), 0.0, last);
  const double end = std::clamp(std::ceil(centre + reach) + 1.0, 0.0, last);
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end)};
}

void paint(const geometry::Ellipse& ellipse, const depth::Intrinsics& intrinsics,
           std::span<std::uint8_t> mask) noexcept {
  const PixelRange columns = range_around(ellipse.u, kCovered * ellipse.a, intrinsics.width);
  const PixelRange rows = range_around(ellipse.v, kCovered * ellipse.a, intrinsics.height);
  const geometry::EllipseGauge gauge(ellipse);
  for (std::uint32_t v = rows.first; v < rows.end; ++v) {
    for (std::uint32_t u = columns.first; u < columns.end; ++u) {
      if (gauge.squared_radius(u, v) <= kCovered * kCovered) {
        mask[static_cast<std::size_t>(v) * intrinsics.width + u] = 1;
      }
    }
  }
}

}  // namespace

void mask_markers(std::span<const markers::Marker> markers, const depth::Intrinsics& intrinsics,
                  std::span<std::uint8_t> mask) noexcept {
  std::fill(mask.begin(), mask.end(), std::uint8_t{0});
  for (const markers::Marker& marker : markers) {
    paint(marker.ellipse, intrinsics, mask);
  }
}

}  // namespace dseam::pipeline
