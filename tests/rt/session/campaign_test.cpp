// SPDX-License-Identifier: Apache-2.0
#include "campaign.hpp"

#include <gtest/gtest.h>

namespace {

using dseam::test::run_seed;
using dseam::test::SeedResult;

TEST(Campaign, a_thousand_seeds_of_faults_never_break_what_must_hold) {
  std::uint64_t faults = 0;
  std::uint64_t latched = 0;
  double hours = 0.0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const SeedResult result = run_seed(seed, 2);
    EXPECT_EQ(result.breach, "") << "seed " << seed;
    faults += result.faults;
    latched += result.latched;
    hours += result.simulated_s / 3600.0;
  }
  RecordProperty("faults", std::to_string(faults));
  RecordProperty("latched", std::to_string(latched));
  RecordProperty("simulated_hours", std::to_string(hours));

  EXPECT_GT(latched, faults / 4);
}

TEST(Campaign, a_seed_replays_to_the_bit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_EQ(run_seed(seed, 3).digest, run_seed(seed, 3).digest);
  }
}

}  // namespace
