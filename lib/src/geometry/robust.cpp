// SPDX-License-Identifier: Apache-2.0
#include "dseam/geometry/robust.hpp"

#include <algorithm>
#include <cstddef>

namespace dseam::geometry {
namespace {

constexpr double kTukeySigmas = 4.685;
constexpr double kSigmaOfMedian = 1.4826;
constexpr double kLeastMedianMm = 1e-4;  // Of points without noise.

}  // namespace

double tukey_cut_mm(std::span<float> magnitudes) noexcept {
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return kTukeySigmas * kSigmaOfMedian * (static_cast<double>(*middle) + kLeastMedianMm);
}

}  // namespace dseam::geometry
