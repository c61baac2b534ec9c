// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/surface/surface_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr int kMaxAttempts = 72;
constexpr double kPatchCells = 5.0;      // Radius of the first patch.
constexpr double kPatchCosine = 0.77;    // 40 degrees: a crease ends the patch.
constexpr double kSameCosine = 0.94;     // 20 degrees: the cell's normal agrees.
constexpr double kExplainCosine = 0.85;  // 32 degrees: near a crease normals are blurred.
constexpr double kMinSupport = 20.0;
constexpr double kMinShare = 0.002;  // Of all cells.
constexpr double kFarReach = 4.0;    // From here on a sample of the cells is enough.
constexpr std::size_t kMaxFarCells = 8000;
constexpr double kGolden = 0.6180339887498949;
// What a kind with more freedom must explain more.
constexpr std::array<double, 4> kThrift = {1.0, 0.98, 0.97, 0.90};
constexpr std::array<SurfaceKind, 4> kKinds = {SurfaceKind::kPlane, SurfaceKind::kSphere,
                                               SurfaceKind::kCylinder, SurfaceKind::kCone};

// How well a cell lies on a surface: 1 on it, 0 where it does not belong to it.
double fit_of(const Surface& surface, const Cell& cell, double tolerance_mm,
              double cosine) noexcept {
  const double d = signed_distance(surface, cell.mean) / tolerance_mm;
  const double inside = 1.0 - d * d;
  if (!(inside > 0.0)) {
    return 0.0;
  }
  return std::abs(outward_normal(surface, cell.mean).dot(cell.normal)) > cosine ? inside : 0.0;
}

bool is_larger(const FoundSurface& a, const FoundSurface& b) noexcept {
  return a.support > b.support;
}

}  // namespace

void SurfaceFinder::run(std::span<const Cell> cells, double cell_mm, double tolerance_mm) noexcept {
  tolerance_mm_ = tolerance_mm;
  surfaces_.clear();
  const std::size_t n = cells.size();
  for (std::size_t i = 0; i < n; ++i) {
    explained_[i] = cells[i].normal.squaredNorm() == 0.0;
  }
  const double least = std::max(kMinSupport, kMinShare * static_cast<double>(n));
  double place = 0.0;
  for (int attempt = 0; attempt < kMaxAttempts && n > 0; ++attempt) {
    place = std::fmod(place + kGolden, 1.0);
    std::size_t seed = static_cast<std::size_t>(place * static_cast<double>(n)) % n;
    std::size_t passed = 0;
    for (; passed < n && explained_[seed]; ++passed) {
      seed = (seed + 1) % n;
    }
    if (passed == n) {
      break;
    }
    const FoundSurface best = best_from(cells, cells[seed], cell_mm);
    explained_[seed] = true;  // Whatever comes of it, it is no seed again.
    if (best.support >= least) {
      keep(best);
      explain(cells, best.surface);
    }
  }
  std::sort(surfaces_.items().begin(), surfaces_.items().end(), is_larger);
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

void SurfaceFinder::collect_patch(std::span<const Cell> cells, const Cell& seed,
                                  double radius_mm) noexcept {
  patch_.clear();
  for (std::size_t i = 0; i < cells.size() && !patch_.full(); ++i) {
    const double cosine = cells[i].normal.dot(seed.normal);
    if (explained_[i] || std::abs(cosine) < kPatchCosine ||
        (cells[i].mean - seed.mean).squaredNorm() > radius_mm * radius_mm) {
      continue;
    }
    Cell cell = cells[i];
    cell.normal *= cosine > 0.0 ? 1.0 : -1.0;
    (void)patch_.append(cell);
  }
}

FoundSurface SurfaceFinder::best_from(std::span<const Cell> cells, const Cell& seed,
                                      double cell_mm) noexcept {
  const double patch_mm = kPatchCells * cell_mm;
  collect_patch(cells, seed, patch_mm);
  FoundSurface best;
  double best_score = 0.0;
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const std::optional<Surface> first = surface_of_patch(kKinds[k], patch_.view());
    if (!first) {
      continue;
    }
    const FoundSurface found = grown(cells, seed, patch_mm, *first);
    if (found.support * kThrift[k] > best_score) {
      best_score = found.support * kThrift[k];
      best = found;
    }
  }
  return best;
}

FoundSurface SurfaceFinder::grown(std::span<const Cell> cells, const Cell& seed, double patch_mm,
                                  Surface surface) const noexcept {
  constexpr std::array<double, 7> kReach = {1.0, 1.0, 1.6, 2.5, 4.0, 1e3, 1e3};
  double support = 0.0;
  for (const double reach : kReach) {
    SurfaceEquations equations;
    const double limit = patch_mm * reach;
    const std::size_t stride = reach < kFarReach ? 1 : 1 + cells.size() / kMaxFarCells;
    for (std::size_t i = 0; i < cells.size(); i += stride) {
      if (explained_[i] || (cells[i].mean - seed.mean).squaredNorm() > limit * limit) {
        continue;
      }
      const double fit = fit_of(surface, cells[i], tolerance_mm_, kSameCosine);
      if (fit > 0.0) {
        equations.add(surface, cells[i].mean, fit);
      }
    }
    support = equations.weight() * static_cast<double>(stride);
    const std::optional<Surface> next = equations.solve(surface);
    if (!next) {
      return {};
    }
    surface = *next;
  }
  return {surface, support};
}

void SurfaceFinder::explain(std::span<const Cell> cells, const Surface& surface) noexcept {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    explained_[i] =
        explained_[i] || fit_of(surface, cells[i], 1.5 * tolerance_mm_, kExplainCosine) > 0.0;
  }
}

}  // namespace dseam::seam
