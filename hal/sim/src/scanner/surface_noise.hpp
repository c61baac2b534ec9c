// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dseam::hal::sim {

/// A random function of place with unit variance everywhere, correlated over a given length.
///
/// Quadratic B-splines on a lattice of that pitch: their correlation is within a few hundredths of
/// exp(-(d / pitch)^2), so it falls to 1/e at the pitch.
class SurfaceNoise {
 public:
  SurfaceNoise(double correlation_mm, std::uint64_t seed);
  [[nodiscard]] double at(const Eigen::Vector3d& p) const noexcept;

 private:
  static constexpr int kSide = 64;  // The function repeats after 64 pitches.

  double per_mm_;
  std::vector<float> lattice_;
};

}  // namespace dseam::hal::sim
