// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dseam/seam/edge/edge_scanner.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kNothing = 1e9;
// How far the points are from showing where between them the surface ends, all round alike.
constexpr double kSmearSpacings = 0.5;
constexpr double kHalfWidthSpacings = 0.3;  // What one bin leaves open.
// A voxel that the edge cuts still gives a point: the points end nearer to the other
// surface than the surface itself.
constexpr double kCutVoxelSpacings = 0.4;
constexpr double kLowestShare = 0.5;  // Of the gap: a dead band takes as much from the other.
constexpr double kMinGapSpacings = 0.85;

}  // namespace

void EdgeScanner::collect_nearest(const EndingSurface& surface) noexcept {
  const auto bin_of = [](double phi_rad) {
    const double turn = phi_rad / kTurnRad;
    const double place = (turn - std::floor(turn)) * double{kBins};
    return std::min(static_cast<std::size_t>(std::max(0.0, place)), kBins - 1);
  };
  for (Nearest& bin : nearest_) {
    bin.surface_mm.fill(kNothing);
    bin.other_mm = kNothing;
  }
  for (const NearPoint& q : surface.side().points.view()) {
    auto& nearest = nearest_[bin_of(q.phi_rad)].surface_mm;
    if (q.trusted && q.away_mm < nearest.back()) {
      nearest.back() = q.away_mm;
      for (std::size_t k = kNearest - 1; k > 0 && nearest[k] < nearest[k - 1]; --k) {
        std::swap(nearest[k], nearest[k - 1]);
      }
    }
  }
  for (const NearPoint& q : surface.other_side().points.view()) {
    double& nearest = nearest_[bin_of(q.phi_rad)].other_mm;
    nearest = q.trusted ? std::min(nearest, q.away_mm) : nearest;
  }
}

void EdgeScanner::run(const EndingSurface& surface, double spacing_mm) noexcept {
  intervals_.clear();
  smear_mm_ = kSmearSpacings * spacing_mm;
  full_ = false;
  collect_nearest(surface);
  // Of points so dense, the k-th nearest to an edge lies k of these steps from it on average.
  const double arc_mm = kTurnRad * surface.fit().joint().nozzle.radius_mm / double{kBins};
  const double step_mm = spacing_mm * spacing_mm / arc_mm;
  const double half_mm = kHalfWidthSpacings * spacing_mm;
  for (std::size_t i = 0; i < kBins; ++i) {
    const Nearest& bin = nearest_[i];
    double edge_mm = kCutVoxelSpacings * spacing_mm;
    for (std::size_t k = 0; k < kNearest; ++k) {
      edge_mm += (bin.surface_mm[k] - static_cast<double>(k + 1) * step_mm) / double{kNearest};
    }
    const bool gap = bin.surface_mm.back() < kNothing && edge_mm > kMinGapSpacings * spacing_mm &&
                     bin.other_mm < kLowestShare * edge_mm + 0.5 * spacing_mm;
    if (gap) {
      const double phi = kTurnRad * (static_cast<double>(i) + 0.5) / double{kBins};
      (void)intervals_.append({phi, edge_mm - half_mm, edge_mm + half_mm});
    }
  }
}

}  // namespace dseam::seam
