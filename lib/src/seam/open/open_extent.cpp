// SPDX-License-Identifier: Apache-2.0
// Where an open seam begins and ends, where its sides end beside it, and what of it was measured.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "dseam/seam/open/open_sides.hpp"

namespace dseam::seam {
namespace {

constexpr float kNothing = 1e9F;
constexpr double kRowsMm = 16.0;  // Of rows beside the seam that show where a plate ends.
constexpr std::size_t kMaxEndRows = 64;
constexpr std::size_t kMinEndRows = 3;
constexpr double kInnerRows = 2.0;     // Points of both sides mix in the first.
constexpr double kLastSpacings = 0.3;  // From the last point of a row to the plate's end.
constexpr double kEdgeBinSpacings = 4.0;
constexpr double kCutVoxelSpacings = 0.4;
constexpr double kMinRaisedSpacings = 0.85;
constexpr double kSpacingsPerBin = 2.5;
constexpr double kNearMm = 3.0;
constexpr double kMaxDeadBandMm = 4.0;
constexpr double kTurnRad = 2.0 * std::numbers::pi;

double median_of(std::span<float> values) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return double{*middle};
}

}  // namespace

// Row by row beside the seam the last point of a plate: the rows' median is not moved by strays.
OpenSides::Ends OpenSides::ends_of(const Side& side) noexcept {
  const double row_mm = std::max(spacing_mm_, kRowsMm / double{kMaxEndRows});
  std::array<float, kMaxEndRows> least;
  std::array<float, kMaxEndRows> most;
  least.fill(kNothing);
  most.fill(-kNothing);
  for (const Point& q : side.points.view()) {
    const double row = double{q.away_mm} / row_mm - kInnerRows;
    if (row >= 0.0 && row < double{kMaxEndRows} && double{q.away_mm} < kRowsMm &&
        std::abs(double{q.off_mm}) < side.cut_mm) {
      const auto r = static_cast<std::size_t>(row);
      least[r] = std::min(least[r], q.s_mm);
      most[r] = std::max(most[r], q.s_mm);
    }
  }
  const auto seen = [](std::array<float, kMaxEndRows>& rows) {
    const auto end =
        std::remove_if(rows.begin(), rows.end(), [](float s) { return std::abs(s) >= kNothing; });
    return std::span<float>(rows.begin(), end);
  };
  const std::span<float> starts = seen(least);
  const std::span<float> ends = seen(most);
  if (starts.size() < kMinEndRows) {
    return {0.0, -1.0, 0.0};
  }
  Ends found{median_of(starts), median_of(ends), 0.0};
  for (float& s : ends) {
    s = std::abs(s - static_cast<float>(found.end_mm));
  }
  found.scatter_mm = median_of(ends);
  found.start_mm -= kLastSpacings * spacing_mm_;
  found.end_mm += kLastSpacings * spacing_mm_;
  return found;
}

// The seam is where both sides are.
bool OpenSides::find_ends() noexcept {
  const Ends first = ends_of(sides_[0]);
  const Ends second = ends_of(sides_[1]);
  start_mm_ = std::max(first.start_mm, second.start_mm);
  end_mm_ = std::min(first.end_mm, second.end_mm);
  end_sigma_mm_ =
      std::hypot(kLastSpacings * spacing_mm_, std::max(first.scatter_mm, second.scatter_mm));
  return end_mm_ - start_mm_ > 4.0 * spacing_mm_;
}

// The points of a side that come nearest to the seam, stretch by stretch.
void OpenSides::collect_nearest(const Side& side) noexcept {
  for (Nearest& bin : nearest_.first(num_bins_)) {
    bin.away_mm.fill(kNothing);
  }
  for (const Point& q : side.points.view()) {
    const double part = (double{q.s_mm} - start_mm_) / (end_mm_ - start_mm_);
    if (!(part >= 0.0 && part < 1.0) || std::abs(double{q.rest_mm}) > side.cut_mm) {
      continue;
    }
    auto& near = nearest_[static_cast<std::size_t>(part * static_cast<double>(num_bins_))].away_mm;
    if (q.away_mm < near.back()) {
      near.back() = q.away_mm;
      for (std::size_t k = kNearest - 1; k > 0 && near[k] < near[k - 1]; --k) {
        std::swap(near[k], near[k - 1]);
      }
    }
  }
}

void OpenSides::find_edge(Side& side) noexcept {
  const double length = end_mm_ - start_mm_;
  num_bins_ = static_cast<std::size_t>(
      std::clamp(length / (kEdgeBinSpacings * spacing_mm_), 2.0, double{kMaxBins}));
  collect_nearest(side);
  const double bin_mm = length / static_cast<double>(num_bins_);
  // Of points so dense, the k-th nearest to an edge lies k of these steps from it on average.
  const double step_mm = spacing_mm_ * spacing_mm_ / bin_mm;
  std::size_t count = 0;
  for (std::size_t i = 0; i < num_bins_; ++i) {
    double edge = kCutVoxelSpacings * spacing_mm_;
    for (std::size_t k = 0; k < kNearest; ++k) {
      edge += (double{nearest_[i].away_mm[k]} - static_cast<double>(k + 1) * step_mm) /
              double{kNearest};
    }
    if (nearest_[i].away_mm.back() < kNothing) {
      const double s = start_mm_ + (static_cast<double>(i) + 0.5) * bin_mm;
      samples_[count++] = {along_of(s), 0.0, edge, 1.0};
    }
  }
  count = without_strays(samples_.first(count));
  if (count * 2 < num_bins_ || !side.edge.fit(samples_.first(count), false)) {
    side.edge = {};
  }
}

// A shadow or a clamp hides a stretch of the edge: what lies far from the median is not it.
std::size_t OpenSides::without_strays(std::span<AlongModel::Sample> samples) noexcept {
  if (samples.empty()) {
    return 0;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    scratch_[i] = static_cast<float>(samples[i].value);
  }
  const double middle = median_of(scratch_.first(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    scratch_[i] = static_cast<float>(std::abs(samples[i].value - middle));
  }
  const double limit = 5.0 * median_of(scratch_.first(samples.size())) + spacing_mm_;
  const auto end = std::remove_if(samples.begin(), samples.end(), [&](const auto& sample) {
    return std::abs(sample.value - middle) > limit;
  });
  return static_cast<std::size_t>(end - samples.begin());
}

// Plates that meet at an angle have an edge only where one stands off the other, which goes on.
void OpenSides::keep_edges(OpenKind kind) noexcept {
  if (kind == OpenKind::kButt) {
    return;
  }
  const double base_mm = sides_[0].edge.fitted() ? sides_[0].edge.at(0.0) : 0.0;
  const double raised_mm = sides_[1].edge.fitted() ? sides_[1].edge.at(0.0) : 0.0;
  sides_[0].edge = {};
  if (raised_mm < kMinRaisedSpacings * spacing_mm_ ||
      base_mm > 0.5 * raised_mm + 0.5 * spacing_mm_) {
    sides_[1].edge = {};
  }
}

void OpenSides::find_coverage() noexcept {
  num_bins_ = static_cast<std::size_t>(
      std::clamp((end_mm_ - start_mm_) / (kSpacingsPerBin * spacing_mm_), 2.0, double{kMaxBins}));
  measured_.fill(true);
  for (const Side& side : sides_) {
    collect_nearest(side);
    std::size_t count = 0;
    const double bin = (end_mm_ - start_mm_) / static_cast<double>(num_bins_);
    for (std::size_t i = 0; i < num_bins_; ++i) {
      const double s = start_mm_ + (static_cast<double>(i) + 0.5) * bin;
      float& nearest = nearest_[i].away_mm[0];
      nearest -= side.edge.fitted() ? static_cast<float>(side.edge.at(along_of(s))) : 0.0F;
      if (nearest < 0.5F * kNothing) {
        scratch_[count++] = nearest;
      }
    }
    const double band_mm =
        count > 0 ? std::clamp(median_of(scratch_.first(count)), 0.0, kMaxDeadBandMm) : 0.0;
    for (std::size_t i = 0; i < num_bins_; ++i) {
      measured_[i] = measured_[i] && double{nearest_[i].away_mm[0]} <= kNearMm + band_mm;
    }
  }
}

bool OpenSides::measured_at(double s_mm) const noexcept {
  const double part = (s_mm - start_mm_) / (end_mm_ - start_mm_);
  const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(num_bins_);
  return measured_[std::min(static_cast<std::size_t>(place), num_bins_ - 1)];
}

void OpenSides::report(bool forward, SeamReport& report) const noexcept {
  const double bin_rad = kTurnRad / static_cast<double>(num_bins_);
  std::size_t open = 0;
  for (std::size_t i = 0; i <= num_bins_; ++i) {
    if (i < num_bins_ && !measured_[i]) {
      ++open;
      continue;
    }
    if (open > 0) {
      const double width = static_cast<double>(open) * bin_rad;
      report.quality.largest_hole_rad = std::max(report.quality.largest_hole_rad, width);
      if (report.num_holes < SeamReport::kMaxHoles) {
        const double end = static_cast<double>(i) * bin_rad;
        report.holes[report.num_holes++] = {forward ? end - width : kTurnRad - end, width};
      }
    }
    open = 0;
  }
}

}  // namespace dseam::seam
