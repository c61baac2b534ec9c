// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dseam::test {

/// What one seed of the campaign came to.
struct SeedResult {
  std::string breach;  ///< Empty where everything held.
  std::uint64_t digest = 0;
  std::uint32_t faults = 0;   ///< Injected.
  std::uint32_t latched = 0;  ///< Of those that the session latched.
  double simulated_s = 0.0;
};

/// A cell that welds again and again while faults of every kind strike in every state, one after
/// the other and at once; after the last one it must still be able to weld.
[[nodiscard]] SeedResult run_seed(std::uint64_t seed, std::uint32_t faults);

}  // namespace dseam::test
