// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/open_sides.hpp"

#include <algorithm>
#include <cmath>

#include "dseam/geometry/robust.hpp"
#include "dseam/seam/surface/surface_fit.hpp"

namespace dseam::seam {
namespace {

constexpr double kBandMm = 20.0;
constexpr double kBeyondMm = 12.0;  // Of the track's ends, which cells gave.
constexpr double kInnerSpacings = 2.0;
constexpr std::size_t kMinPoints = 60;
constexpr int kRefinements = 3;
constexpr double kPatchMm = 8.0;  // The length over which depth noise hangs together.
constexpr double kMinPatchWeight = 3.0;
constexpr double kFullPatchWeight = 8.0;
constexpr double kMaxPlateStepMm = 3.0;

}  // namespace

OpenSides::OpenSides(std::size_t max_points, Arena& arena) noexcept
    : scratch_(arena.take<float>(max_points / 2)),
      sums_(arena.take<Sum>(kMaxBins * kRows)),
      samples_(arena.take<AlongModel::Sample>(kMaxBins * kRows)),
      nearest_(arena.take<Nearest>(kMaxBins)) {
  for (Side& side : sides_) {
    side.points = Buffer<Point>(arena.take<Point>(max_points / 2));
  }
}

bool OpenSides::run(const cloud::CloudView& cloud, const Scale& scale, OpenJoint& joint,
                    SeamTrack& track) noexcept {
  spacing_mm_ = scale.spacing_mm;
  pivot_ = track.at(0.5 * track.length_mm()).p;
  const bool butt = joint.kind == OpenKind::kButt;
  double tolerance = butt ? std::max(kMaxPlateStepMm, scale.tolerance_mm) : scale.tolerance_mm;
  for (int i = 0; i < 2; ++i) {
    select(cloud, joint, track, tolerance);
    if (!refine(0, joint) || !refine(1, joint)) {
      return false;
    }
    tolerance = 1.5 * scale.tolerance_mm;
    if (!butt && !track.lay_onto(joint.surface[0], joint.surface[1])) {
      return false;
    }
  }
  select(cloud, joint, track, tolerance);
  measure(0, joint);
  measure(1, joint);
  if (!find_ends() || !model(sides_[0]) || !model(sides_[1])) {
    return false;
  }
  find_edge(sides_[0]);
  find_edge(sides_[1]);
  keep_edges(joint.kind);
  find_coverage();
  return joint.kind == OpenKind::kFillet || (sides_[0].edge.fitted() && sides_[1].edge.fitted());
}

void OpenSides::select(const cloud::CloudView& cloud, const OpenJoint& joint,
                       const SeamTrack& track, double tolerance_mm) noexcept {
  sides_[0].points.clear();
  sides_[1].points.clear();
  num_dropped_ = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p(cloud.x[i], cloud.y[i], cloud.z[i]);
    const std::array<double, 2> off{joint.off(0, p), joint.off(1, p)};
    const std::array<double, 2> away{joint.away(0, p), joint.away(1, p)};
    const auto is_on = [&](std::size_t k) {
      return std::abs(off[k]) < tolerance_mm && away[k] > 0.0 && away[k] < kBandMm;
    };
    const bool first = is_on(0) && !(is_on(1) && away[1] > away[0]);
    if (!first && !is_on(1)) {
      continue;
    }
    const std::size_t k = first ? 0 : 1;
    const double s = track.s_of(p);
    if (s > -kBeyondMm && s < track.length_mm() + kBeyondMm) {
      const Point point{(p - pivot_).cast<float>(), static_cast<float>(s),
                        static_cast<float>(away[k]), static_cast<float>(off[k]),
                        static_cast<float>(off[k])};
      num_dropped_ += sides_[k].points.append(point) ? 0U : 1U;
    }
  }
}

// The robust cut from the residuals of the points clear of the seam; 0 where they are few.
double OpenSides::cut_of(const Side& side) noexcept {
  std::size_t n = 0;
  for (const Point& q : side.points.view()) {
    if (double{q.away_mm} > kInnerSpacings * spacing_mm_) {
      scratch_[n++] = std::abs(q.rest_mm);
    }
  }
  return n < kMinPoints ? 0.0 : geometry::tukey_cut_mm(scratch_.first(n));
}

bool OpenSides::refine(std::size_t side, OpenJoint& joint) noexcept {
  Surface& surface = joint.surface[side];
  for (int i = 0; i < kRefinements; ++i) {
    const double cut = cut_of(sides_[side]);
    if (cut == 0.0) {
      return false;
    }
    SurfaceEquations equations(surface);
    for (const Point& q : sides_[side].points.view()) {
      const double weight = double{q.away_mm} > kInnerSpacings * spacing_mm_
                                ? geometry::tukey(double{q.off_mm} / cut)
                                : 0.0;
      if (weight > 0.0) {
        equations.add(pivot_ + q.from_pivot.cast<double>(), weight);
      }
    }
    const std::optional<Surface> next = equations.solve();
    if (!next) {
      return false;
    }
    surface = *next;
    measure(side, joint);
  }
  return true;
}

void OpenSides::measure(std::size_t side, const OpenJoint& joint) noexcept {
  for (Point& q : sides_[side].points.items()) {
    q.off_mm = static_cast<float>(joint.off(side, pivot_ + q.from_pivot.cast<double>()));
    q.rest_mm = q.off_mm;
  }
  sides_[side].cut_mm = cut_of(sides_[side]);
}

// Means of patches: unlike points these err nearly independently.
bool OpenSides::model(Side& side) noexcept {
  const double inner = kInnerSpacings * spacing_mm_;
  const double length = end_mm_ - start_mm_;
  const auto columns = static_cast<std::size_t>(
      std::clamp(length / std::max(kPatchMm, 3.0 * spacing_mm_), 3.0, double{kMaxBins}));
  std::fill_n(sums_.begin(), columns * kRows, Sum{});
  for (const Point& q : side.points.view()) {
    const double place = (double{q.s_mm} - start_mm_) / length * static_cast<double>(columns);
    const double row = (double{q.away_mm} - inner) / (kBandMm - inner) * double{kRows};
    const double weight = geometry::tukey(double{q.off_mm} / side.cut_mm);
    if (row < 0.0 || place < 0.0 || place >= static_cast<double>(columns) || !(weight > 0.0)) {
      continue;
    }
    const auto r = std::min(static_cast<std::size_t>(row), kRows - 1);
    Sum& sum = sums_[r * columns + static_cast<std::size_t>(place)];
    sum.s += weight * double{q.s_mm};
    sum.away += weight * double{q.away_mm};
    sum.off += weight * double{q.off_mm};
    sum.weight += weight;
  }
  std::size_t count = 0;
  for (const Sum& sum : sums_.first(columns * kRows)) {
    if (sum.weight >= kMinPatchWeight) {
      samples_[count++] = {along_of(sum.s / sum.weight), sum.away / sum.weight / kBandMm,
                           sum.off / sum.weight, std::min(1.0, sum.weight / kFullPatchWeight)};
    }
  }
  if (!side.deviation.fit(samples_.first(count), true)) {
    return false;
  }
  for (Point& q : side.points.items()) {
    q.rest_mm =
        static_cast<float>(double{q.off_mm} - side.deviation.at(along_of(double{q.s_mm}),
                                                                double{q.away_mm} / kBandMm));
  }
  side.cut_mm = cut_of(side);
  return side.cut_mm > 0.0;
}

ResidualStats OpenSides::stats_of(std::size_t side) noexcept {
  constexpr double kNearMm = 6.0;
  ResidualStats stats;
  double squares = 0.0;
  for (const Point& q : sides_[side].points.view()) {
    const double rest = std::abs(double{q.rest_mm});
    if (double{q.away_mm} < kNearMm && rest < sides_[side].cut_mm) {
      scratch_[stats.count++] = static_cast<float>(rest);
      squares += rest * rest;
      stats.max_mm = std::max(stats.max_mm, rest);
    }
  }
  if (stats.count > 0) {
    const auto end = scratch_.begin() + static_cast<std::ptrdiff_t>(stats.count);
    const auto place = scratch_.begin() + static_cast<std::ptrdiff_t>(stats.count * 95 / 100);
    std::nth_element(scratch_.begin(), place, end);
    stats.p95_mm = double{*place};
    stats.rms_mm = std::sqrt(squares / stats.count);
  }
  return stats;
}

}  // namespace dseam::seam
