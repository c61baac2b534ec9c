// SPDX-License-Identifier: Apache-2.0
// The accuracy table of the seam: rows of simulated joints, so many seeds each, true poses given.
// Use: seam_campaign [SEEDS] [ROW-NAME-PART] [FIRST-SEED]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "campaign/seam_row.hpp"

namespace {

using dseam::campaign::kRows;
using dseam::campaign::Outcome;
using dseam::campaign::Row;

struct Total {
  double squares = 0.0;
  double points = 0.0;
  double max_mm = 0.0;
  double worst_rms_mm = 0.0;
  std::uint64_t worst_seed = 0;
  double least_coverage = 1.0;
  int refused = 0;
  int seeds = 0;
  int inside_lateral = 0;  // NEES within the 95 % quantile.
  int inside_normal = 0;
  double ms = 0.0;
};

void add(Total& total, const Outcome& outcome, std::uint64_t seed) {
  ++total.seeds;
  total.ms += outcome.milliseconds;
  if (!outcome.report.weld()) {
    ++total.refused;
    return;
  }
  total.squares += outcome.rms_mm * outcome.rms_mm * outcome.num_points;
  total.points += outcome.num_points;
  total.max_mm = std::max(total.max_mm, outcome.max_mm);
  total.least_coverage = std::min(total.least_coverage, outcome.coverage);
  total.inside_lateral += outcome.nees_lateral < 3.841 ? 1 : 0;
  total.inside_normal += outcome.nees_normal < 3.841 ? 1 : 0;
  if (outcome.rms_mm >= total.worst_rms_mm) {
    total.worst_rms_mm = outcome.rms_mm;
    total.worst_seed = seed;
  }
}

void print_seed(const Outcome& o, std::uint64_t seed) {
  std::printf(
      "    seed %3llu %-16s rms %.4f max %.4f cov %.3f nees %6.2f %6.2f sig %.4f %.4f gap "
      "%.2f/%.2f edge %u"
      " harm %d/%d bias L %+.4f N %+.4f n %u %.0f ms\n",
      static_cast<unsigned long long>(seed), name(o.report.refusal), o.rms_mm, o.max_mm, o.coverage,
      o.nees_lateral, o.nees_normal, o.report.quality.mean_sigma_lateral_mm,
      o.report.quality.mean_sigma_normal_mm, o.report.joint.mean_gap_mm, o.true_gap_mm,
      o.report.joint.num_edge_intervals, o.report.joint.shell_harmonics,
      o.report.joint.nozzle_harmonics, o.mean_lateral_mm, o.mean_normal_mm, o.report.num_points,
      o.milliseconds);
}

void print_total(const char* what, const Total& t) {
  std::printf(
      "%-22s seeds %3d refused %2d coverage >= %.3f rmse %.4f max %.4f worst seed %llu: %.4f "
      "NEES inside %d/%d lateral %d/%d normal, %.0f ms\n",
      what, t.seeds, t.refused, t.least_coverage,
      t.points > 0.0 ? std::sqrt(t.squares / t.points) : 0.0, t.max_mm,
      static_cast<unsigned long long>(t.worst_seed), t.worst_rms_mm, t.inside_lateral,
      t.seeds - t.refused, t.inside_normal, t.seeds - t.refused, t.ms / t.seeds);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  const char* part = argc > 2 ? argv[2] : "";
  const std::uint64_t first = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
  for (const Row& row : kRows) {
    if (std::strstr(row.name, part) == nullptr) {
      continue;
    }
    Total total;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(seeds); ++seed) {
      const Outcome outcome = dseam::campaign::run(row, seed);
      print_seed(outcome, seed);
      std::fflush(stdout);
      add(total, outcome, seed);
    }
    print_total(row.name, total);
    std::fflush(stdout);
  }
  return 0;
}
