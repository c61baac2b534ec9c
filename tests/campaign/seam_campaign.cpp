// SPDX-License-Identifier: Apache-2.0
// The accuracy table of the seam: rows of simulated joints, so many seeds each.
// Fails where a row misses what is asked of it, or, with a scanner drawn for each scan, where the
// predicted errors are not those that were.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>

#include "campaign/seam_run.hpp"
#include "support/accuracy/chi_squared.hpp"

namespace {

using dseam::campaign::kRows;
using dseam::campaign::Outcome;
using dseam::campaign::Row;
using dseam::campaign::Scanner;
using dseam::test::NeesTally;

constexpr std::uint32_t kEnoughForNees = 300;

struct Total {
  double squares = 0.0;
  double points = 0.0;
  double max_mm = 0.0;
  double worst_rms_mm = 0.0;
  std::uint64_t worst_seed = 0;
  double least_coverage = 1.0;
  int refused = 0;
  int seeds = 0;
  double ms = 0.0;

  [[nodiscard]] double rmse_mm() const { return points > 0.0 ? std::sqrt(squares / points) : 0.0; }
};

struct Nees {
  NeesTally lateral;
  NeesTally normal;
};

void add(Total& total, const Outcome& outcome, std::uint64_t seed) {
  ++total.seeds;
  total.ms += outcome.milliseconds;
  total.least_coverage = std::min(total.least_coverage, outcome.coverage);
  if (!outcome.report.weld()) {
    ++total.refused;
    return;
  }
  total.squares += outcome.rms_mm * outcome.rms_mm * outcome.num_points;
  total.points += outcome.num_points;
  total.max_mm = std::max(total.max_mm, outcome.max_mm);
  if (outcome.rms_mm >= total.worst_rms_mm) {
    total.worst_rms_mm = outcome.rms_mm;
    total.worst_seed = seed;
  }
}

void print_seed(const Outcome& o, std::uint64_t seed) {
  const auto& q = o.report.quality;
  std::printf(
      "    seed %3llu %-12s rms %.4f max %.4f coverage %.3f nees %5.2f %5.2f sigma %.4f %.4f gap "
      "%.2f/%.2f bias lateral %+.4f normal %+.4f, %u points %.0f ms\n",
      static_cast<unsigned long long>(seed), name(o.report.refusal), o.rms_mm, o.max_mm, o.coverage,
      o.nees_lateral, o.nees_normal, q.mean_sigma_lateral_mm, q.mean_sigma_normal_mm,
      o.report.joint.mean_gap_mm, o.true_gap_mm, o.mean_lateral_mm, o.mean_normal_mm,
      o.report.num_points, o.milliseconds);
}

/// Every single seed stays under twice the row's figure.
bool keeps(const Row& row, const Total& t) {
  if (!row.weldable()) {
    return t.refused == t.seeds;
  }
  return t.refused == 0 && t.rmse_mm() <= row.rmse_mm && t.worst_rms_mm <= 2.0 * row.rmse_mm &&
         t.max_mm <= row.max_mm && t.least_coverage >= row.coverage;
}

void print_total(const Row& row, const Total& t, const Nees& nees, bool kept) {
  std::printf(
      "%-17s %-4s seeds %d refused %d coverage %.3f (%.2f) rmse %.4f (%.2f) max %.4f (%.2f) worst "
      "%.4f seed %llu, NEES inside %.2f lateral %.2f normal, %.0f ms\n",
      row.name, kept ? "ok" : "MISS", t.seeds, t.refused, t.least_coverage, row.coverage,
      t.rmse_mm(), row.rmse_mm, t.max_mm, row.max_mm, t.worst_rms_mm,
      static_cast<unsigned long long>(t.worst_seed), nees.lateral.share_inside(),
      nees.normal.share_inside(), t.ms / t.seeds);
  std::fflush(stdout);
}

struct Options {
  int seeds = 3;
  std::uint64_t first = 1;
  std::uint32_t shrink = 1;
  std::string row;
  bool quiet = false;
  bool drawn = false;
};

bool measure(const Row& row, const Options& options, Nees& all) {
  const Scanner scanner = options.drawn ? Scanner::kDrawn : Scanner::kDefault;
  Total total;
  Nees nees;
  for (int i = 0; i < options.seeds; ++i) {
    const std::uint64_t seed = options.first + static_cast<std::uint64_t>(i);
    const Outcome outcome = run(row, seed, options.shrink, scanner);
    add(total, outcome, seed);
    if (row.weldable() && outcome.num_points > 0.0) {
      for (Nees* tally : {&nees, &all}) {
        tally->lateral.add(outcome.nees_lateral, 1);
        tally->normal.add(outcome.nees_normal, 1);
      }
    }
    if (!options.quiet) {
      print_seed(outcome, seed);
    }
  }
  const bool kept = keeps(row, total);
  print_total(row, total, nees, kept);
  return kept;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Measures the seam's accuracy on simulated scans."};
  app.add_option("--seeds", options.seeds, "of each row")->check(CLI::PositiveNumber);
  app.add_option("--first", options.first, "the first seed");
  app.add_option("--shrink", options.shrink, "the frames so many times")->check(CLI::Range(1, 4));
  app.add_option("--row", options.row, "only rows with this in their name");
  app.add_flag("--quiet", options.quiet, "only the rows' totals");
  app.add_flag("--drawn", options.drawn, "the depth bowl anew for each scan: for the sigmas");
  CLI11_PARSE(app, argc, argv);
  Nees all;
  bool kept = true;
  for (const Row& row : kRows) {
    if (std::string(row.name).find(options.row) != std::string::npos) {
      kept = measure(row, options, all) && kept;
    }
  }
  std::printf("NEES of %u scans: inside %.3f lateral, %.3f normal; mean ratio %.2f, %.2f\n",
              all.lateral.count(), all.lateral.share_inside(), all.normal.share_inside(),
              all.lateral.mean_ratio(), all.normal.mean_ratio());
  const bool enough = options.drawn && all.lateral.count() >= kEnoughForNees;
  return kept && (!enough || (all.lateral.passes() && all.normal.passes())) ? 0 : 1;
}
