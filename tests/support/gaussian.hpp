// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "dseam/base/random.hpp"

namespace dseam::test {

/// One draw of the standard normal distribution, the same on every platform but for libm's last
/// bit.
///
/// Source:  Box and Muller.
inline double gaussian(Pcg32& random) {
  const double u = 1.0 - random.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * random.uniform());
}

}  // namespace dseam::test
