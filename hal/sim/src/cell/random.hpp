// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "dseam/base/random.hpp"

namespace dseam::hal::sim {

/// What a stream of random numbers is for: streams of one seed are independent of each other.
enum class Stream : std::uint64_t {
  kClutter = 1,
  kMarkers,
  kPoses,
  kReports,
  kPixels,
  kField,
  kSpots
};

[[nodiscard]] inline Pcg32 stream(std::uint64_t seed, Stream purpose) noexcept {
  return Pcg32(seed * 0x9E3779B97F4A7C15ULL, static_cast<std::uint64_t>(purpose));
}

[[nodiscard]] inline double between(Pcg32& random, double low, double high) noexcept {
  return low + (high - low) * random.uniform();
}

/// Standard normal, after Box and Muller; two uniform numbers a call, so that streams stay aligned.
[[nodiscard]] inline double normal(Pcg32& random) noexcept {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * random.uniform());
}

}  // namespace dseam::hal::sim
