// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dseam {

/// PCG32: small, seeded, and the same sequence on every compiler and processor.
///
/// Source:  O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms
///          for Random Number Generation", HMC-CS-2014-0905 (XSH-RR 64/32).
class Pcg32 {
 public:
  explicit constexpr Pcg32(std::uint64_t seed, std::uint64_t stream = 0) noexcept
      : increment_((stream << 1U) | 1U) {
    (void)next();
    state_ += seed;
    (void)next();
  }

  constexpr std::uint32_t next() noexcept {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto turn = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> turn) | (shifted << ((32U - turn) & 31U));
  }
  /// Evenly in [0, bound), without bias worth naming for bounds far under 2^32; 0 for bound 0.
  constexpr std::uint32_t below(std::uint32_t bound) noexcept {
    return static_cast<std::uint32_t>((std::uint64_t{next()} * bound) >> 32U);
  }
  /// Evenly in [0, 1), 53 bits.
  constexpr double uniform() noexcept {
    const std::uint64_t high = next() >> 5U;
    const std::uint64_t low = next() >> 6U;
    return static_cast<double>((high << 26U) | low) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

}  // namespace dseam
