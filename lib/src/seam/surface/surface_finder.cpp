// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr int kMaxRounds = 20;
constexpr int kCompetitions = 4;
constexpr int kSeedsOfRound = 6;
constexpr int kTolerances = 4;           // Each half the one before.
constexpr double kPrecisionWorth = 0.5;  // Of halving it, in cells: log 2 of a cell's evidence.
constexpr std::array<double, 2> kPatchCells = {5.0, 3.0};  // Radius of a first patch.
constexpr double kPatchCosine = 0.77;                      // 40 degrees: a crease ends the patch.
constexpr double kSameRad = 0.35;                          // 20 degrees: the cell's normal agrees.
constexpr double kExplainRad = 0.55;  // 32 degrees: near a crease normals are blurred.
constexpr double kMinSupport = 20.0;
constexpr double kMinShare = 0.002;  // Of all cells.
constexpr double kFarReach = 3.0;
constexpr std::size_t kMaxFarCells = 8000;
constexpr double kGolden = 0.6180339887498949;
// What a kind with more freedom must explain more.
constexpr std::array<double, 4> kThrift = {1.0, 0.98, 0.97, 0.90};
constexpr std::array<SurfaceKind, 4> kKinds = {SurfaceKind::kPlane, SurfaceKind::kSphere,
                                               SurfaceKind::kCylinder, SurfaceKind::kCone};

// How well a cell lies on a surface: 1 on it, 0 where it does not belong to it.
[[gnu::always_inline]] inline double fit_of(const SurfaceProbe& probe,
                                            const SurfaceProbe::Contact& contact, const Cell& cell,
                                            double tolerance_mm, double cosine) noexcept {
  if (!(std::abs(contact.distance_mm) < tolerance_mm) ||
      !(std::abs(probe.normal(contact).dot(cell.normal)) > cosine)) {
    return 0.0;
  }
  const double d = contact.distance_mm / tolerance_mm;
  return 1.0 - d * d;
}

double fit_of(const SurfaceProbe& probe, const Cell& cell, double tolerance_mm,
              double cosine) noexcept {
  return fit_of(probe, probe.touch(cell.mean), cell, tolerance_mm, cosine);
}

bool is_larger(const FoundSurface& a, const FoundSurface& b) noexcept {
  return a.support > b.support;
}

}  // namespace

void SurfaceFinder::run(std::span<const Cell> cells, const CellScale& scale) noexcept {
  const double cell_mm = scale.cell_mm;
  tolerance_mm_ = scale.tolerance_mm();
  same_cosine_ = std::cos(kSameRad + scale.slack_rad());
  explain_cosine_ = std::cos(kExplainRad + scale.slack_rad());
  surfaces_.clear();
  const std::size_t n = cells.size();
  for (std::size_t i = 0; i < n; ++i) {
    explained_[i] = cells[i].normal.squaredNorm() == 0.0;
  }
  const double least = std::max(kMinSupport, kMinShare * static_cast<double>(n));
  double place = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    const FoundSurface best = best_of_seeds(cells, cell_mm, least, place);
    if (best.support >= least) {
      keep(best);
      explain(cells, best.surface);
    }
  }
  for (int round = 0; round < kCompetitions; ++round) {
    compete(cells);
  }
  drop_weaker_than(least);
  std::sort(surfaces_.items().begin(), surfaces_.items().end(), is_larger);
}

// Every cell goes to the surface on which it lies best, and every surface is fitted to its own: one
// that was found first has taken cells of its neighbours.
void SurfaceFinder::compete(std::span<const Cell> cells) noexcept {
  const std::size_t stride = 1 + cells.size() / kMaxFarCells;
  std::array<SurfaceProbe, kMaxSurfaces> probes;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    probes[k] = SurfaceProbe(surfaces_[k].surface);
  }
  for (std::size_t i = 0; i < cells.size(); i += stride) {
    double best = 0.0;
    owner_[i] = kMaxSurfaces;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      const double fit = fit_of(probes[k], cells[i], tolerance_mm_, explain_cosine_);
      if (fit > best) {
        best = fit;
        owner_[i] = static_cast<std::uint8_t>(k);
      }
    }
  }
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    Surface& surface = surfaces_[k].surface;
    SurfaceEquations equations(surface);
    for (std::size_t i = 0; i < cells.size(); i += stride) {
      if (owner_[i] == k) {
        equations.add(cells[i].mean,
                      fit_of(equations.probe(), cells[i], tolerance_mm_, explain_cosine_));
      }
    }
    surface = equations.solve().value_or(surface);
    surfaces_[k].support = equations.weight() * static_cast<double>(stride);
  }
}

void SurfaceFinder::drop_weaker_than(double least) noexcept {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < surfaces_.size(); ++k) {
    if (surfaces_[k].support >= least) {
      surfaces_[kept++] = surfaces_[k];
    }
  }
  surfaces_.resize(kept);
}

// From seeds spread over what is unexplained; one of which nothing comes is no seed again.
FoundSurface SurfaceFinder::best_of_seeds(std::span<const Cell> cells, double cell_mm, double least,
                                          double& place) noexcept {
  FoundSurface best;
  const std::size_t n = cells.size();
  for (int i = 0; i < kSeedsOfRound && n > 0; ++i) {
    place = std::fmod(place + kGolden, 1.0);
    std::size_t seed = static_cast<std::size_t>(place * static_cast<double>(n)) % n;
    std::size_t passed = 0;
    for (; passed < n && explained_[seed]; ++passed) {
      seed = (seed + 1) % n;
    }
    if (passed == n) {
      break;
    }
    list_open(n);
    const FoundSurface found = best_from(cells, cells[seed], cell_mm);
    explained_[seed] = found.support < least;
    if (found.support >= least && found.score > best.score) {
      best = found;
    }
  }
  return best;
}

// Small planes of clutter do not keep a nozzle out of a full list.
void SurfaceFinder::keep(const FoundSurface& found) noexcept {
  if (surfaces_.append(found)) {
    return;
  }
  const auto weakest =
      std::max_element(surfaces_.items().begin(), surfaces_.items().end(), is_larger);
  if (is_larger(found, *weakest)) {
    *weakest = found;
  }
}

void SurfaceFinder::list_open(std::size_t num_cells) noexcept {
  open_.clear();
  for (std::size_t i = 0; i < num_cells; ++i) {
    if (!explained_[i]) {
      (void)open_.append(static_cast<std::uint32_t>(i));
    }
  }
}

// What lies around the seed, and of it what turns as the seed does.
void SurfaceFinder::collect_patch(std::span<const Cell> cells, const Cell& seed,
                                  double radius_mm) noexcept {
  patch_.clear();
  near_.clear();
  const double reach_mm = kFarReach * radius_mm;
  for (const std::uint32_t i : open_.view()) {
    const double squared = (cells[i].mean - seed.mean).squaredNorm();
    if (squared > reach_mm * reach_mm) {
      continue;
    }
    (void)near_.append(i);
    const double cosine = cells[i].normal.dot(seed.normal);
    if (patch_.full() || std::abs(cosine) < kPatchCosine || squared > radius_mm * radius_mm) {
      continue;
    }
    Cell cell = cells[i];
    cell.normal *= cosine > 0.0 ? 1.0 : -1.0;
    (void)patch_.append(cell);
  }
}

FoundSurface SurfaceFinder::best_from(std::span<const Cell> cells, const Cell& seed,
                                      double cell_mm) noexcept {
  FoundSurface best;
  for (const double cells_across : kPatchCells) {
    const double patch_mm = cells_across * cell_mm;
    collect_patch(cells, seed, patch_mm);
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      const std::optional<Surface> first = surface_of_patch(kKinds[k], patch_.view());
      if (!first) {
        continue;
      }
      FoundSurface found = grown(cells, seed, patch_mm, *first);
      found.score *= kThrift[k];
      if (found.score > best.score) {
        best = found;
      }
    }
  }
  return best;
}

// The patch grows to all cells; then the tolerance is halved as long as precision outweighs the
// cells that are lost. A surface that runs through two others loses most of them.
FoundSurface SurfaceFinder::grown(std::span<const Cell> cells, const Cell& seed, double patch_mm,
                                  Surface surface) const noexcept {
  constexpr std::array<double, 6> kReach = {1.0, 1.0, 1.6, 2.5, 4.0, 1e3};
  for (const double reach : kReach) {
    const FoundSurface next =
        refitted(cells, {seed.mean, patch_mm * reach, reach > kFarReach}, surface, tolerance_mm_);
    if (next.support == 0.0) {
      return {};
    }
    surface = next.surface;
  }
  FoundSurface best;
  double tolerance_mm = tolerance_mm_;
  for (int i = 0; i < kTolerances; ++i) {
    const Ball everywhere{seed.mean, 1e3 * patch_mm, true};
    FoundSurface next = refitted(cells, everywhere, surface, tolerance_mm);
    next.score = next.support * (1.0 + kPrecisionWorth * i);
    if (next.score <= best.score) {
      break;
    }
    best = next;
    surface = next.surface;
    tolerance_mm *= 0.5;
  }
  return best;
}

// One step of the fit to the cells in the ball that lie on the surface; nothing where it fails.
FoundSurface SurfaceFinder::refitted(std::span<const Cell> cells, const Ball& ball,
                                     const Surface& surface, double tolerance_mm) const noexcept {
  SurfaceEquations equations(surface);
  const SurfaceProbe& probe = equations.probe();
  const std::span<const std::uint32_t> some = ball.far ? open_.view() : near_.view();
  const std::size_t stride = 1 + some.size() / kMaxFarCells;
  for (std::size_t k = 0; k < some.size(); k += stride) {
    const Cell& cell = cells[some[k]];
    if ((cell.mean - ball.centre).squaredNorm() > ball.radius_mm * ball.radius_mm) {
      continue;
    }
    const SurfaceProbe::Contact contact = probe.touch(cell.mean);
    const double fit = fit_of(probe, contact, cell, tolerance_mm, same_cosine_);
    if (fit > 0.0) {
      equations.add(contact, fit);
    }
  }
  const std::optional<Surface> next = equations.solve();
  return next ? FoundSurface{*next, equations.weight() * static_cast<double>(stride), 0.0}
              : FoundSurface{};
}

void SurfaceFinder::explain(std::span<const Cell> cells, const Surface& surface) noexcept {
  const SurfaceProbe probe(surface);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    explained_[i] =
        explained_[i] || fit_of(probe, cells[i], 1.5 * tolerance_mm_, explain_cosine_) > 0.0;
  }
}

}  // namespace dseam::seam
