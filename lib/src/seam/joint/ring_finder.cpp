// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/ring_finder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "seam/joint/ring_support.hpp"

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kMinBinShare = 0.25;      // A ring seen less than this is not listed as one.
constexpr double kEqualShare = 0.80;       // Scores closer than this are equally good.
constexpr double kRadiusTolerance = 0.15;  // Of the expected radius.
constexpr double kMinJointCosine = 0.97;   // Surfaces nearer than 14 degrees do not make a joint.

constexpr double kMaxWallShare = 0.6;  // Of a nozzle's radius.
constexpr double kMinWallMm = 1.5;
constexpr double kOutside = 4.0;  // An outside is preferred to a bore: it may be half hidden.
constexpr double kCoaxialCosine = 0.99;
constexpr double kMaxOffAxisMm = 5.0;
constexpr double kMaxOffAxisShare = 0.1;  // Of the radius.
constexpr double kSamePlaceShare = 0.15;  // Of the radius.
constexpr double kSameRadiusShare = 0.1;

using Roots = std::array<Eigen::Vector3d, RingFinder::kBins>;

// Where the two surfaces meet around the nozzle; nothing unless they do all the way, at an angle.
std::optional<Roots> roots_of(const Joint& joint, const NozzleFrame& frame) noexcept {
  Roots roots;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const double phi_rad = (static_cast<double>(i) + 0.5) * kTurnRad / RingFinder::kBins;
    const auto root = root_at(joint, frame, phi_rad);
    if (!root || std::abs(shell_normal(joint, *root).dot(outward_normal(joint.nozzle, *root))) >
                     kMinJointCosine) {
      return std::nullopt;
    }
    roots[i] = *root;
  }
  return roots;
}

bool contains(const RingHint& hint, const Eigen::Vector3d& p) noexcept {
  return !hint.has_region || ((p.array() >= hint.region_min.array()).all() &&
                              (p.array() <= hint.region_max.array()).all());
}

bool is_coaxial(const RingCandidate& a, const RingCandidate& b) noexcept {
  const Eigen::Vector3d between = a.centre_base - b.centre_base;
  return std::abs(a.axis_base.dot(b.axis_base)) > kCoaxialCosine &&
         between.cross(b.axis_base).norm() <
             std::max(
                 {kMaxOffAxisMm, kMaxOffAxisShare * a.radius_mm, kMaxOffAxisShare * b.radius_mm});
}

// Two fits of one wall, the worse one led astray by what stands beside it: no choice to be made.
bool is_same_wall(const RingCandidate& a, const RingCandidate& b) noexcept {
  return (a.centre_base - b.centre_base).norm() < kSamePlaceShare * a.radius_mm &&
         std::abs(a.radius_mm - b.radius_mm) < kSameRadiusShare * a.radius_mm;
}

// A ring farther up the same cone is narrower too: the wall is measured at the inner ring's height.
bool is_bore_of(const RingCandidate& inner, const RingCandidate& outer,
                const Surface& outside) noexcept {
  const double up_mm = outside.axis.dot(inner.centre_base - outside.point);
  const double wall = outside.radius_mm + outside.slope * up_mm - inner.radius_mm;
  return wall > kMinWallMm && wall < kMaxWallShare * outer.radius_mm && is_coaxial(inner, outer);
}

// A large ring is seldom backed all round by chance, but easily along a long stretch.
double merit_of(const RingCandidate& ring) noexcept { return ring.score_mm * ring.coverage; }

bool is_round(const Surface& surface) noexcept {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kCone;
}

Surface turned_over(Surface surface) noexcept {
  surface.axis = -surface.axis;
  surface.slope = -surface.slope;
  return surface;
}

// Where the nozzle's axis meets the plane it stands on.
Eigen::Vector3d foot_of(const Joint& joint) noexcept {
  const Surface& nozzle = joint.nozzle;
  const double along =
      -signed_distance(joint.shell, nozzle.point) / joint.shell.axis.dot(nozzle.axis);
  return nozzle.point + along * nozzle.axis;
}

RingFate fate_of(const RingCandidate& ring, int num_below, const RingHint& hint,
                 const Eigen::Vector3d& any_root) noexcept {
  if (num_below > RingFinder::kBins / 2 && ring.coverage < 0.5) {
    return RingFate::kConvex;
  }
  if (ring.coverage < kMinBinShare) {
    return RingFate::kUnsupported;
  }
  if (!contains(hint, ring.centre_base) || !contains(hint, any_root)) {
    return RingFate::kOutsideRegion;
  }
  const double off = std::abs(ring.radius_mm - hint.radius_mm);
  return hint.radius_mm > 0.0 && off > kRadiusTolerance * hint.radius_mm ? RingFate::kWrongRadius
                                                                         : RingFate::kOutscored;
}

}  // namespace

void RingFinder::clear(double half_cell_mm) noexcept {
  rings_.clear();
  joints_.clear();
  feet_.clear();
  half_cell_mm_ = half_cell_mm;
}

RingFinder::Choice RingFinder::run(std::span<const Cell> cells,
                                   std::span<const FoundSurface> surfaces, const CellScale& scale,
                                   const RingHint& hint, SeamReport& report) noexcept {
  clear(0.0);
  for (const FoundSurface& nozzle : surfaces) {
    if (!is_round(nozzle.surface)) {
      continue;
    }
    for (const FoundSurface& shell : surfaces) {
      if (&shell == &nozzle) {
        continue;
      }
      consider(cells, {shell.surface, nozzle.surface}, scale, hint);
      consider(cells, {shell.surface, turned_over(nozzle.surface)}, scale, hint);
    }
  }
  return choose(report);
}

RingFinder::Choice RingFinder::run_at_feet(const cloud::CloudView& cloud,
                                           std::span<const Cell> cells,
                                           std::span<const FoundSurface> surfaces,
                                           const CellScale& scale, const RingHint& hint,
                                           SeamReport& report) noexcept {
  clear(0.5 * scale.cell_mm);
  std::size_t nozzles = 0;
  for (const FoundSurface& found : surfaces) {
    if (!is_round(found.surface) || ++nozzles > kMaxFeet / 2) {
      continue;
    }
    for (const Surface& nozzle : {found.surface, turned_over(found.surface)}) {
      const auto foot = foot_.run(cloud, cells, nozzle, surfaces, scale);
      if (foot) {
        keep_foot(*foot);
      }
    }
  }
  for (const FootSearch::Found& foot : feet_.view()) {
    consider(cells, foot.joint, scale, hint);
  }
  Choice choice = choose(report);
  for (const FootSearch::Found& foot : feet_.view()) {
    if (foot.joint.nozzle.point == choice.joint.nozzle.point) {
      choice.bore = foot.bore;
    }
  }
  return choice;
}

// Two sides of one wall, or two fits to it, have one foot: the better one stays.
void RingFinder::keep_foot(const FootSearch::Found& found) noexcept {
  const auto same = std::ranges::find_if(feet_.items(), [&](const FootSearch::Found& other) {
    const double near_mm = std::max(found.joint.nozzle.radius_mm, other.joint.nozzle.radius_mm);
    return (foot_of(found.joint) - foot_of(other.joint)).norm() < near_mm;
  });
  if (same == feet_.items().end()) {
    (void)feet_.append(found);
  } else if (found.merit > same->merit) {
    *same = found;
  }
}

void RingFinder::consider(std::span<const Cell> cells, const Joint& given, const CellScale& scale,
                          const RingHint& hint) noexcept {
  Joint joint = given;
  if (joint.shell.kind == SurfaceKind::kPlane &&
      joint.shell_sign * joint.shell.axis.dot(joint.nozzle.axis) < 0.0) {
    joint.shell_sign = -1.0;
  }
  const auto is_outside = [&](const Eigen::Vector3d& p) { return shell_distance(joint, p) >= 0.0; };
  if (!hint.viewpoints.empty() && std::ranges::none_of(hint.viewpoints, is_outside)) {
    return;  // Nobody saw the shell from that side.
  }
  const NozzleFrame frame = frame_of(joint.nozzle);
  const auto closed = roots_of(joint, frame);
  if (!closed) {
    return;
  }
  const Roots& roots = *closed;
  RingCandidate ring;
  const RingSupport support = support_of(cells, joint, frame, scale, half_cell_mm_);
  int num_both = 0;
  int num_below = 0;
  int num_past = 0;
  for (std::size_t i = 0; i < kBins; ++i) {
    ring.centre_base += roots[i] / kBins;
    const bool both = support.shell_outside[i] > 0 && support.nozzle_above[i] > 0;
    const Eigen::Vector3d step = roots[(i + 1) % kBins] - roots[i];
    ring.score_mm += both ? step.norm() : 0.0;
    num_both += both ? 1 : 0;
    num_below += support.shell_outside[i] > 0 && support.nozzle_below[i] > 0 ? 1 : 0;
    num_past += support.nozzle_below[i] > 0 && support.shell_outside[i] == 0 ? 1 : 0;
    ring.radius_mm +=
        (roots[i] - joint.nozzle.point).cross(joint.nozzle.axis).norm() / double{kBins};
  }
  ring.coverage = static_cast<double>(num_both) / double{kBins};
  // Where the wall is seen to go on past the shell, the shell is not what it stands on.
  ring.score_mm *= std::max(0.0, 1.0 - static_cast<double>(num_past) / std::max(1, num_both));
  ring.axis_base = joint.nozzle.axis;
  ring.shell = joint.shell.kind;
  ring.nozzle = joint.nozzle.kind;
  ring.fate = fate_of(ring, num_below, hint, roots[0]);
  keep(ring, joint);
}

// One ring may be found from two surfaces that describe the same wall: the better one stays.
void RingFinder::keep(const RingCandidate& ring, const Joint& joint) noexcept {
  const double near_mm = kSamePlaceShare * ring.radius_mm;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    if ((rings_[i].centre_base - ring.centre_base).norm() < near_mm &&
        std::abs(rings_[i].radius_mm - ring.radius_mm) < kMinWallMm) {
      if (merit_of(ring) > merit_of(rings_[i])) {
        rings_[i] = ring;
        joints_[i] = joint;
      }
      return;
    }
  }
  if (rings_.append(ring)) {
    (void)joints_.append(joint);
  }
}

// Inside another ring about the same axis: the joint is on the nozzle's outside, not in its bore.
bool RingFinder::is_bore(const RingCandidate& ring) const noexcept {
  bool found = false;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    found = found || (rings_[i].fate == RingFate::kOutscored &&
                      kOutside * merit_of(rings_[i]) > merit_of(ring) &&
                      is_bore_of(ring, rings_[i], joints_[i].nozzle));
  }
  return found;
}

// The largest of them: what lies nearer to it than to the nozzle is not the nozzle's outside.
std::optional<Surface> RingFinder::bore_of(std::size_t chosen) const noexcept {
  std::size_t best = chosen;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    const bool larger = best == chosen || rings_[i].radius_mm > rings_[best].radius_mm;
    if (larger && is_bore_of(rings_[i], rings_[chosen], joints_[chosen].nozzle)) {
      best = i;
    }
  }
  return best == chosen ? std::nullopt : std::optional(joints_[best].nozzle);
}

RingFinder::Choice RingFinder::choose(SeamReport& report) noexcept {
  const auto eligible = [&](std::size_t i) {
    return rings_[i].fate == RingFate::kOutscored && !is_bore(rings_[i]);
  };
  std::size_t best = rings_.size();
  bool elsewhere = false;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    elsewhere = elsewhere || rings_[i].fate == RingFate::kOutsideRegion ||
                rings_[i].fate == RingFate::kWrongRadius;
    if (eligible(i) && (best == rings_.size() || merit_of(rings_[i]) > merit_of(rings_[best]))) {
      best = i;
    }
  }
  Choice choice{elsewhere ? Refusal::kOutsideRegion : Refusal::kNoRing, {}, {}};
  if (best != rings_.size()) {
    choice = {Refusal::kNone, joints_[best], bore_of(best)};
    for (std::size_t i = 0; i < rings_.size(); ++i) {
      if (i != best && eligible(i) && !is_same_wall(rings_[i], rings_[best]) &&
          merit_of(rings_[i]) > kEqualShare * merit_of(rings_[best])) {
        rings_[i].fate = RingFate::kEqual;
        choice.refusal = Refusal::kTwoRings;
      }
    }
    rings_[best].fate = RingFate::kChosen;
  }
  std::sort(
      rings_.items().begin(), rings_.items().end(),
      [](const RingCandidate& a, const RingCandidate& b) { return merit_of(a) > merit_of(b); });
  report.num_candidates =
      static_cast<std::uint32_t>(std::min(rings_.size(), SeamReport::kMaxCandidates));
  std::copy_n(rings_.view().begin(), report.num_candidates, report.candidates.begin());
  return choice;
}

}  // namespace dseam::seam
