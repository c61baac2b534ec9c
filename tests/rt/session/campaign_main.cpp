// SPDX-License-Identifier: Apache-2.0
// The long campaign: `rt_campaign FAULTS [FIRST-SEED]`. A failing seed is printed; the same seed
// alone replays it.
#include <cstdio>
#include <cstdlib>

#include "campaign.hpp"

int main(int argc, char** argv) {
  const std::uint64_t wanted = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000;
  std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::uint64_t faults = 0;
  std::uint64_t latched = 0;
  std::uint64_t broken = 0;
  double hours = 0.0;
  for (; faults < wanted; ++seed) {
    const dseam::test::SeedResult result = dseam::test::run_seed(seed, 20);
    faults += result.faults;
    latched += result.latched;
    hours += result.simulated_s / 3600.0;
    if (!result.breach.empty()) {
      ++broken;
      std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), result.breach.c_str());
    }
  }
  std::printf("%llu faults, %llu latched, %.1f simulated hours, %llu seeds broken\n",
              static_cast<unsigned long long>(faults), static_cast<unsigned long long>(latched),
              hours, static_cast<unsigned long long>(broken));
  return broken == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
