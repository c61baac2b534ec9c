// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/curve/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kNearMm = 3.0;
constexpr double kMaxDeadBandMm = 4.0;
constexpr double kSpacingsPerBin = 2.5;
constexpr double kHiddenSpacings = 0.3;
constexpr float kNothing = 1e9F;

}  // namespace

std::size_t RingCoverage::bin_of(double phi_rad) const noexcept {
  const double turn = phi_rad / kTurnRad;
  const double place = (turn - std::floor(turn)) * static_cast<double>(num_bins_);
  return std::min(static_cast<std::size_t>(std::max(0.0, place)), num_bins_ - 1);
}

double RingCoverage::median_of(const Distances& nearest) noexcept {
  const auto end =
      std::copy_if(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(num_bins_),
                   sorted_.begin(), [](float d) { return d < kNothing; });
  if (end == sorted_.begin()) {
    return 0.0;
  }
  const auto middle = sorted_.begin() + (end - sorted_.begin()) / 2;
  std::nth_element(sorted_.begin(), middle, end);
  return std::max(0.0, double{*middle});
}

// How near to where it ends a surface was seen, bin by bin.
void RingCoverage::collect(const JointFit::Side& side, const EdgeCurve* edge,
                           Distances& nearest) noexcept {
  nearest.fill(kNothing);
  for (const NearPoint& q : side.points.view()) {
    const double start = edge == nullptr ? 0.0 : edge->at(q.phi_rad);
    float& least = nearest[bin_of(q.phi_rad)];
    least = q.trusted ? std::min(least, static_cast<float>(q.away_mm - start)) : least;
  }
}

void RingCoverage::run(const JointFit& fit, const JointEdges& edges, double spacing_mm) noexcept {
  const double round_mm = kTurnRad * fit.joint().nozzle.radius_mm;
  num_bins_ = static_cast<std::size_t>(
      std::clamp(round_mm / (kSpacingsPerBin * spacing_mm), 48.0, double{kMaxBins}));
  collect(fit.shell(), edges.shell, shell_);
  collect(fit.nozzle(), edges.nozzle, nozzle_);
  const double shell_mm = median_of(shell_);
  const double nozzle_mm = median_of(nozzle_);
  const double hidden_mm = shell_mm - nozzle_mm;
  hidden_gap_mm_ =
      edges.shell == nullptr && hidden_mm > kHiddenSpacings * spacing_mm ? shell_mm : 0.0;
  const double shell_band = std::min(shell_mm, kMaxDeadBandMm);
  const double nozzle_band = std::min(nozzle_mm, kMaxDeadBandMm);
  for (std::size_t i = 0; i < num_bins_; ++i) {
    measured_[i] =
        double{shell_[i]} <= kNearMm + shell_band && double{nozzle_[i]} <= kNearMm + nozzle_band;
  }
}

bool RingCoverage::measured_at(double phi_rad) const noexcept {
  return num_bins_ > 0 && measured_[bin_of(phi_rad)];
}

double RingCoverage::hole_at(double phi_rad) const noexcept {
  if (num_bins_ == 0) {
    return kTurnRad;
  }
  const std::size_t start = bin_of(phi_rad);
  std::size_t width = 0;
  for (std::size_t i = start; width < num_bins_ && !measured_[i]; i = (i + 1) % num_bins_) {
    ++width;
  }
  for (std::size_t i = start; width < num_bins_ && width > 0;) {
    i = (i + num_bins_ - 1) % num_bins_;
    if (measured_[i]) {
      break;
    }
    ++width;
  }
  return static_cast<double>(width) * kTurnRad / static_cast<double>(num_bins_);
}

void RingCoverage::report(bool counter_clockwise, SeamReport& report) const noexcept {
  const double bin_rad = kTurnRad / static_cast<double>(std::max<std::size_t>(1, num_bins_));
  std::size_t first = 0;
  while (first < num_bins_ && !measured_[first]) {
    ++first;
  }
  if (first >= num_bins_) {
    report.num_holes = 1;
    report.holes[0] = {0.0, kTurnRad};
    report.quality.largest_hole_rad = kTurnRad;
    return;
  }
  std::size_t open = 0;
  for (std::size_t i = 1; i <= num_bins_; ++i) {
    const std::size_t bin = (first + i) % num_bins_;
    if (!measured_[bin]) {
      ++open;
      continue;
    }
    if (open > 0) {
      const double width = static_cast<double>(open) * bin_rad;
      const double end = static_cast<double>(bin) * bin_rad;
      const double start = counter_clockwise ? end - width : -end;
      report.quality.largest_hole_rad = std::max(report.quality.largest_hole_rad, width);
      if (report.num_holes < SeamReport::kMaxHoles) {
        report.holes[report.num_holes++] = {start - kTurnRad * std::floor(start / kTurnRad), width};
      }
      open = 0;
    }
  }
}

}  // namespace dseam::seam
