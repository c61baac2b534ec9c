// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "scanner/frame.hpp"

namespace dseam::hal::sim {
namespace {

bool looks_alike(const Sample& a, const Sample& b) {
  return a.body == b.body && a.surface == b.surface && a.paint == b.paint;
}

bool at_edge(const std::vector<Sample>& samples, const depth::Intrinsics& k, std::uint32_t u,
             std::uint32_t v) {
  const std::uint32_t left = u > 0 ? u - 1 : u;
  const std::uint32_t right = std::min(u + 1, k.width - 1);
  const std::uint32_t top = v > 0 ? v - 1 : v;
  const std::uint32_t bottom = std::min(v + 1, k.height - 1);
  const Sample& centre = samples[std::size_t{v} * k.width + u];
  for (std::uint32_t y = top; y <= bottom; ++y) {
    for (std::uint32_t x = left; x <= right; ++x) {
      if (!looks_alike(samples[std::size_t{y} * k.width + x], centre)) {
        return true;
      }
    }
  }
  return false;
}

float mean_luminance(const Viewpoint& view, std::uint32_t u, std::uint32_t v,
                     std::span<const std::uint16_t> candidates) {
  constexpr int kPerSide = 5;
  float sum = 0.0F;
  for (int i = 0; i < kPerSide; ++i) {
    for (int j = 0; j < kPerSide; ++j) {
      const double du = (i + 0.5) / kPerSide - 0.5;
      const double dv = (j + 0.5) / kPerSide - 0.5;
      sum += sample(view, u + du, v + dv, candidates).luminance;
    }
  }
  return sum / (kPerSide * kPerSide);
}

}  // namespace

void smooth_edges(const Viewpoint& view, const Tiling& tiling, std::vector<Sample>& samples) {
  const depth::Intrinsics& k = view.intrinsics;
  for (std::uint32_t v = 0; v < k.height; ++v) {
    for (std::uint32_t u = 0; u < k.width; ++u) {
      if (at_edge(samples, k, u, v)) {
        samples[std::size_t{v} * k.width + u].luminance =
            mean_luminance(view, u, v, tiling.candidates(u, v));
      }
    }
  }
}

}  // namespace dseam::hal::sim
