// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/depth/depth_image.hpp"
#include "support/shapes/clouds.hpp"

namespace dseam::bench {

inline constexpr double kShellRadiusMm = 108.0;
inline constexpr double kNozzleRadiusMm = 59.2;
inline constexpr double kAxesRad = 62.9 * std::numbers::pi / 180.0;

/// The paper's part as a scanner sees it: an oblique nozzle on a shell, noise of 0.02 mm, a few
/// stray points. `num_points` decides the density; 120,887 is the paper's.
inline test::OwnedCloud part_cloud(std::size_t num_points) {
  Pcg32 random(7);
  const auto noise = [&] {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
      sum += random.uniform();
    }
    return 0.02 * sum;
  };
  test::OwnedCloud cloud;
  const auto add = [&](double x, double y, double z) {
    cloud.add(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  };
  const double tilt_c = std::cos(kAxesRad);
  const double tilt_s = std::sin(kAxesRad);
  const auto rows = static_cast<int>(std::sqrt(static_cast<double>(num_points) * 0.62));
  const int columns = static_cast<int>(static_cast<double>(num_points) / 0.8 / rows) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns && cloud.size() < num_points; ++column) {
      const double s = (row + random.uniform()) / rows;
      const double t = (column + random.uniform()) / columns;
      if (random.below(500) == 0) {
        add(s * 320.0 - 160.0, t * 240.0 - 120.0, 20.0 + 200.0 * random.uniform());
      } else if (s < 0.68) {  // Shell along x, seen from above.
        const double angle = (t - 0.5) * 2.4;
        const double radius = kShellRadiusMm + noise();
        const double x = s / 0.68 * 300.0 - 150.0;
        const double y = radius * std::sin(angle);
        const double z = radius * std::cos(angle);
        // Inside the nozzle there is a hole.
        const double across = x * tilt_s - z * tilt_c + kShellRadiusMm * tilt_c;
        if (across * across + y * y > kNozzleRadiusMm * kNozzleRadiusMm) {
          add(x, y, z);
        }
      } else {
        const double angle = t * 2.0 * std::numbers::pi;
        const double radius = kNozzleRadiusMm + noise();
        const double along = (s - 0.68) / 0.32 * 110.0 - 20.0;
        const double across = radius * std::cos(angle);
        const double y = radius * std::sin(angle);
        const double x = across * tilt_s + along * tilt_c;
        const double z = kShellRadiusMm - across * tilt_c + along * tilt_s;
        if (y * y + z * z > kShellRadiusMm * kShellRadiusMm) {
          add(x, y, z);
        }
      }
    }
  }
  return cloud;
}

inline constexpr std::uint32_t kFrameWidth = 1296;
inline constexpr std::uint32_t kFrameHeight = 966;

/// A full frame of the shell from 500 mm, ray by ray.
inline std::vector<std::uint16_t> shell_frame(depth::DepthImage& image) {
  image.intrinsics = {kFrameWidth, kFrameHeight, 2073.6, 2073.6, 647.5, 482.5};
  image.mm_per_count = 1.0 / 64.0;
  std::vector<std::uint16_t> counts(std::size_t{kFrameWidth} * kFrameHeight);
  Pcg32 random(3);
  for (std::uint32_t v = 0; v < kFrameHeight; ++v) {
    for (std::uint32_t u = 0; u < kFrameWidth; ++u) {
      const double ry = (v - image.intrinsics.cy) / image.intrinsics.fy;
      // (ry z)^2 + (z - 608)^2 = 108^2
      const double a = ry * ry + 1.0;
      const double root = 608.0 * 608.0 - a * (608.0 * 608.0 - 108.0 * 108.0);
      const double z = root > 0.0 ? (608.0 - std::sqrt(root)) / a : 620.0;
      const bool is_lost = random.below(100) == 0;
      counts[std::size_t{v} * kFrameWidth + u] =
          is_lost ? 0 : static_cast<std::uint16_t>(z * 64.0 + random.uniform() * 2.0);
    }
  }
  image.depth = counts;
  return counts;
}

}  // namespace dseam::bench
