// SPDX-License-Identifier: Apache-2.0
// Splices simulated scans, prints the table of splice errors, and fails where a figure is missed:
//   splice_campaign [ROW|all [SEEDS [FIRST_SEED [SHRINK]]]]      SHRINK 2: frames of half the size
#include <cstdio>
#include <cstdlib>
#include <string>

#include "splice_row.hpp"

int main(int argc, char** argv) {
  using namespace dseam::test;
  const std::string wanted = argc > 1 ? argv[1] : "all";
  const std::uint64_t seeds = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 200;
  const std::uint64_t first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  const std::uint64_t shrink = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  bool any = false;
  bool all_hold = true;
  for (const SpliceRow& row : splice_rows()) {
    if (wanted != "all" && wanted != row.name) {
      continue;
    }
    SpliceTable table;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      table.add(seed, splice_seed(row, seed, static_cast<std::uint32_t>(shrink)));
    }
    table.print(row);
    std::fflush(stdout);
    any = true;
    all_hold = all_hold && table.holds(row);
  }
  return any && all_hold ? EXIT_SUCCESS : EXIT_FAILURE;
}
