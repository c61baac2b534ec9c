// SPDX-License-Identifier: Apache-2.0
#include "scanner/surface_noise.hpp"

#include <array>
#include <cmath>

#include "cell/random.hpp"

namespace dseam::hal::sim {
namespace {

struct Weights {
  int first = 0;
  std::array<double, 3> weight{};
};

/// The three quadratic B-splines over `x`, scaled so that their squares sum to one.
Weights weights_at(double x) {
  const double nearest = std::floor(x + 0.5);
  const double t = x - nearest;
  const std::array<double, 3> w{0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t,
                                0.5 * (0.5 + t) * (0.5 + t)};
  const double scale = 1.0 / std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  return {static_cast<int>(nearest) - 1, {scale * w[0], scale * w[1], scale * w[2]}};
}

}  // namespace

SurfaceNoise::SurfaceNoise(double correlation_mm, std::uint64_t seed)
    : per_mm_(1.0 / correlation_mm), lattice_(kSide * kSide * kSide) {
  Pcg32 random = stream(seed, Stream::kField);
  for (float& value : lattice_) {
    value = static_cast<float>(normal(random));
  }
}

double SurfaceNoise::at(const Eigen::Vector3d& p) const noexcept {
  const Weights x = weights_at(p.x() * per_mm_);
  const Weights y = weights_at(p.y() * per_mm_);
  const Weights z = weights_at(p.z() * per_mm_);
  constexpr auto kWrap = static_cast<unsigned>(kSide - 1);
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const unsigned row_z = static_cast<unsigned>(z.first + static_cast<int>(k)) & kWrap;
    for (std::size_t j = 0; j < 3; ++j) {
      const unsigned row =
          row_z * kSide + (static_cast<unsigned>(y.first + static_cast<int>(j)) & kWrap);
      double along = 0.0;
      for (std::size_t i = 0; i < 3; ++i) {
        const unsigned column = static_cast<unsigned>(x.first + static_cast<int>(i)) & kWrap;
        along += x.weight[i] * static_cast<double>(lattice_[row * kSide + column]);
      }
      sum += z.weight[k] * y.weight[j] * along;
    }
  }
  return sum;
}

}  // namespace dseam::hal::sim
