// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/slit_finder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dseam/base/random.hpp"

namespace dseam::seam {
namespace {

constexpr int kDirections = 720;
constexpr double kBinSpacings = 0.3;
constexpr std::size_t kWindow = 4;     // Bins: a row of a grid's points falls into each window.
constexpr double kEmptyShare = 0.25;   // Of what the neighbourhood holds.
constexpr double kMinExpected = 40.0;  // Points of a filled window: fewer may be missing by chance.
constexpr double kMaxWidthMm = 9.0;
constexpr double kBesideMm = 8.0;        // On each side it must be filled.
constexpr double kMinFilledShare = 0.3;  // Of the mean of all bins.
constexpr double kMaxStepTolerances = 1.6;
constexpr double kFewShare = 0.35;  // Of the pixels that a cell of the plates has on average.
constexpr double kMaxStepMm = 3.0;  // One plate above the other.
constexpr double kMinLengthMm = 20.0;
constexpr double kStretchSpacings = 3.0;
constexpr double kSameMm = 10.0;
constexpr std::size_t kMaxStretches = 1024;
constexpr double kOverStretchMm = 4.0;
constexpr double kOverMm = 25.0;       // Height in which something may stand over a slit.
constexpr double kMaxOverShare = 0.6;  // Of its length: clamps hold plates, too.

// Up is where the cameras are, or else base z.
double air_sign_of(const Surface& plane, const RingHint& hint) noexcept {
  double sum = hint.viewpoints.empty() ? plane.axis.z() : 0.0;
  for (const Eigen::Vector3d& viewpoint : hint.viewpoints) {
    sum += signed_distance(plane, viewpoint);
  }
  return sum < 0.0 ? -1.0 : 1.0;
}

}  // namespace

void SlitFinder::run(const cloud::FusedCloudView& cloud, std::span<const FoundSurface> surfaces,
                     const Scale& scale, const RingHint& hint,
                     Buffer<OpenCandidate>& found) noexcept {
  const std::size_t before = found.size();
  for (const FoundSurface& surface : surfaces) {
    if (surface.surface.kind != SurfaceKind::kPlane) {
      continue;
    }
    const auto slit = consider(cloud, surface.surface, scale, hint);
    if (!slit) {
      continue;
    }
    const auto items = found.items().subspan(before);
    const auto same = std::find_if(items.begin(), items.end(), [&](const OpenCandidate& other) {
      return (other.centre - slit->centre).norm() < kSameMm;
    });
    if (same == items.end()) {
      (void)found.append(*slit);
    } else if (slit->score_mm > same->score_mm) {
      *same = *slit;
    }
  }
}

// How much wider apart the points that are kept lie. Cells of few pixels are what hangs in the gap.
double SlitFinder::flatten(const cloud::FusedCloudView& cloud, const Surface& plane,
                           double step_mm) noexcept {
  const AcrossAxis frame = across(plane.axis);
  points_.clear();
  const std::size_t n = cloud.points.size();
  const auto at = [&](std::size_t i) {
    return Eigen::Vector3d(cloud.points.x[i], cloud.points.y[i], cloud.points.z[i]);
  };
  const auto is_on = [&](std::size_t i) {
    return std::abs(signed_distance(plane, at(i))) < step_mm;
  };
  const auto pixels_of = [&](std::size_t i) { return cloud.count.empty() ? 1.0 : cloud.count[i]; };
  std::size_t on_plane = 0;
  double pixels = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    on_plane += is_on(i) ? 1U : 0U;
    pixels += is_on(i) ? pixels_of(i) : 0.0;
  }
  const double few = kFewShare * pixels / std::max(1.0, static_cast<double>(on_plane));
  // A share of the points by a draw: every n-th of a grid's rows would itself leave slits.
  const double share = std::min(1.0, 0.95 * double{kMaxPoints} / static_cast<double>(on_plane + 1));
  Pcg32 draw(on_plane);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_on(i) && pixels_of(i) >= few && draw.uniform() < share) {
      const Eigen::Vector3d q = at(i) - plane.point;
      (void)points_.append(
          {static_cast<float>(q.dot(frame.u)), static_cast<float>(q.dot(frame.v))});
    }
  }
  return std::sqrt(1.0 / share);
}

// The emptiest place between two filled ones, of all places in one direction.
SlitFinder::Slit SlitFinder::slit_along(double angle_rad, double spacing_mm) noexcept {
  const auto c = static_cast<float>(std::cos(angle_rad));
  const auto s = static_cast<float>(std::sin(angle_rad));
  const auto [least, most] = std::minmax_element(
      points_.view().begin(), points_.view().end(),
      [&](const Flat& a, const Flat& b) { return c * a.v - s * a.u < c * b.v - s * b.u; });
  low_mm_ = double{c * least->v - s * least->u};
  const double width_mm = double{c * most->v - s * most->u} - low_mm_;
  bin_mm_ = std::max(kBinSpacings * spacing_mm, width_mm / static_cast<double>(kBins - 1));
  used_ = std::min(kBins, static_cast<std::size_t>(width_mm / bin_mm_) + 1);
  std::fill_n(bins_.begin(), used_, std::uint16_t{0});
  const auto low = static_cast<float>(low_mm_);
  const auto per_mm = static_cast<float>(1.0 / bin_mm_);
  for (const Flat& p : points_.view()) {
    const auto bin = static_cast<std::size_t>(std::max(0.0F, (c * p.v - s * p.u - low) * per_mm));
    ++bins_[std::min(bin, used_ - 1)];
  }
  float mean = 0.0F;
  for (std::size_t i = 0; i + kWindow <= used_; ++i) {
    smooth_[i] = 0.0F;
    for (std::size_t k = 0; k < kWindow; ++k) {
      smooth_[i] += static_cast<float>(bins_[i + k]) / float{kWindow};
    }
    mean += smooth_[i] / static_cast<float>(used_);
  }
  const std::size_t count = used_ >= kWindow ? used_ - kWindow : 0;
  const auto reach = static_cast<std::size_t>(kBesideMm / bin_mm_);
  const float empty = static_cast<float>(kEmptyShare) * mean;
  Slit best;
  for (std::size_t i = reach; i + reach < count; ++i) {
    std::size_t end = i;
    while (end < count && smooth_[end] < empty) {
      ++end;
    }
    const Slit slit = end > i && end + reach < count ? judge(i, end, reach) : Slit{};
    best = slit.depth > best.depth ? slit : best;
    i = std::max(i, end);
  }
  best.angle_rad = angle_rad;
  return best;
}

// Bins `first` to `last` are nearly empty: how deep is it against what lies on both sides?
SlitFinder::Slit SlitFinder::judge(std::size_t first, std::size_t last,
                                   std::size_t reach) const noexcept {
  const auto filled = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t i = from; i < from + reach; ++i) {
      sum += double{smooth_[i]} / static_cast<double>(reach);
    }
    return sum;
  };
  const double mean = static_cast<double>(points_.size()) / static_cast<double>(used_);
  const double sides = std::min(filled(first - reach), filled(last));
  const double width_mm = static_cast<double>(last - first) * bin_mm_;
  if (sides < kMinFilledShare * mean || sides * double{kWindow} < kMinExpected ||
      width_mm > kMaxWidthMm) {
    return {};
  }
  Slit slit;
  double weights = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const double empty = std::max(0.0, 1.0 - double{smooth_[i]} / sides);
    slit.depth += empty * empty * bin_mm_;
    slit.middle_mm += empty * static_cast<double>(i);
    weights += empty;
  }
  const double bin = weights > 0.0 ? slit.middle_mm / weights : 0.0;
  slit.middle_mm = low_mm_ + (bin + 0.5 * double{kWindow}) * bin_mm_;
  return slit;
}

// Where along it points lie on both of its sides.
SlitFinder::Sides SlitFinder::sides_of(const Slit& slit, double spacing_mm) noexcept {
  const auto c = static_cast<float>(std::cos(slit.angle_rad));
  const auto s = static_cast<float>(std::sin(slit.angle_rad));
  const double step_mm = std::max(kStretchSpacings * spacing_mm, 2.0);
  const std::size_t middle = kMaxStretches / 2;
  std::fill_n(bins_.begin(), kMaxStretches,
              std::uint16_t{0});  // Bit 0: one side, bit 1: the other.
  Sides sides;
  for (const Flat& p : points_.view()) {
    const double off = double{c * p.v - s * p.u} - slit.middle_mm;
    const double place = double{c * p.u + s * p.v} / step_mm + static_cast<double>(middle);
    if (std::abs(off) < kBesideMm && place >= 0.0 && place < double{kMaxStretches}) {
      auto& bits = bins_[static_cast<std::size_t>(place)];
      bits = static_cast<std::uint16_t>(bits | (off > 0.0 ? 1U : 2U));
    }
    sides.lead += off > 0.0 ? 1.0 : -1.0;
  }
  std::size_t first = kMaxStretches;
  std::size_t last = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < kMaxStretches; ++i) {
    if (bins_[i] == 3) {
      first = std::min(first, i);
      last = i;
      ++both;
    }
  }
  if (both == 0) {
    return sides;
  }
  const auto at = [&](std::size_t i) {
    return (static_cast<double>(i) - static_cast<double>(middle)) * step_mm;
  };
  sides.start_mm = at(first);
  sides.end_mm = at(last + 1);
  sides.coverage = static_cast<double>(both) / static_cast<double>(last + 1 - first);
  return sides;
}

// A standing plate hides what it stands on: no gap, but the foot of two fillets.
bool SlitFinder::is_built_over(const cloud::CloudView& cloud, const OpenCandidate& slit) noexcept {
  const OpenJoint& joint = slit.joint;
  const Eigen::Vector3d along = joint.across.cross(joint.surface[0].axis);
  const auto count = static_cast<std::size_t>(
      std::clamp(slit.length_mm / kOverStretchMm, 1.0, double{kMaxStretches}));
  std::fill_n(bins_.begin(), count, std::uint16_t{0});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d p(cloud.x[i], cloud.y[i], cloud.z[i]);
    const double height = joint.off(0, p);
    const double place = along.dot(p - slit.centre) / slit.length_mm + 0.5;
    if (height > kMaxStepMm && height < kOverMm && place >= 0.0 && place < 1.0 &&
        std::abs(joint.across.dot(p - slit.centre)) < kMaxWidthMm) {
      bins_[static_cast<std::size_t>(place * static_cast<double>(count))] = 1;
    }
  }
  const auto over = std::count(bins_.begin(), bins_.begin() + static_cast<std::ptrdiff_t>(count),
                               std::uint16_t{1});
  return static_cast<double>(over) > kMaxOverShare * static_cast<double>(count);
}

std::optional<OpenCandidate> SlitFinder::consider(const cloud::FusedCloudView& cloud,
                                                  const Surface& plane, const Scale& scale,
                                                  const RingHint& hint) noexcept {
  const double spacing_mm =
      scale.spacing_mm * flatten(cloud, plane, kMaxStepTolerances * scale.tolerance_mm);
  if (points_.size() < 100) {
    return std::nullopt;
  }
  Slit best;
  for (int i = 0; i < kDirections; ++i) {
    const Slit slit = slit_along(std::numbers::pi * i / kDirections, spacing_mm);
    best = slit.depth > best.depth ? slit : best;
  }
  const Sides sides = best.depth > 0.0 ? sides_of(best, spacing_mm) : Sides{};
  const double length = sides.end_mm - sides.start_mm;
  if (length < kMinLengthMm || sides.coverage < 0.3) {
    return std::nullopt;
  }
  const AcrossAxis frame = across(plane.axis);
  const double c = std::cos(best.angle_rad);
  const double s = std::sin(best.angle_rad);
  OpenCandidate candidate;
  OpenJoint& joint = candidate.joint;
  joint.kind = OpenKind::kButt;
  joint.surface = {plane, plane};
  joint.air_sign.fill(air_sign_of(plane, hint));
  joint.across = c * frame.v - s * frame.u;
  const double lead = sides.lead >= 0.0 ? 1.0 : -1.0;
  joint.seam_sign = {lead, -lead};
  candidate.centre = plane.point + best.middle_mm * joint.across +
                     0.5 * (sides.start_mm + sides.end_mm) * (c * frame.u + s * frame.v);
  joint.middle = candidate.centre;
  candidate.length_mm = length;
  candidate.coverage = sides.coverage;
  candidate.score_mm = length * sides.coverage;
  candidate.fate =
      contains(hint, candidate.centre) ? RingFate::kOutscored : RingFate::kOutsideRegion;
  return is_built_over(cloud.points, candidate) ? std::nullopt : std::optional(candidate);
}

void SlitFinder::lay_track(const OpenCandidate& slit, double step_mm, SeamTrack& track) noexcept {
  track.clear();
  const Eigen::Vector3d along = slit.joint.across.cross(slit.joint.surface[0].axis).normalized();
  const double count =
      std::clamp(slit.length_mm / step_mm, 4.0, double{SeamTrack::kMaxStations} - 1.0);
  for (double i = 0.0; i <= count; i += 1.0) {
    (void)track.append(slit.centre + (i / count - 0.5) * slit.length_mm * along);
  }
  track.finish();
}

}  // namespace dseam::seam
