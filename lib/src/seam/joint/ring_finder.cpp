// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/joint/ring_finder.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace dseam::seam {
namespace {

constexpr double kTurnRad = 2.0 * std::numbers::pi;
constexpr double kSupportRad = 0.61;       // 35 degrees: cells at a joint have blurred normals.
constexpr double kMinBinShare = 0.25;      // A ring seen less than this is not listed as one.
constexpr double kEqualShare = 0.80;       // Scores closer than this are equally good.
constexpr double kRadiusTolerance = 0.15;  // Of the expected radius.
constexpr double kMinJointCosine = 0.97;   // Surfaces nearer than 14 degrees do not make a joint.

constexpr double kMaxWallShare = 0.6;  // Of a nozzle's radius.
constexpr double kMinWallMm = 1.5;
constexpr double kOutside =
    4.0;  // What an outside is preferred to a bore by: it may be half hidden.
constexpr double kCoaxialCosine = 0.99;
constexpr double kMaxOffAxisMm = 5.0;
constexpr double kMaxOffAxisShare = 0.1;  // Of the radius.
constexpr double kOtherSideCosine = -0.1;
constexpr double kSamePlaceShare = 0.15;  // Of the radius.
constexpr double kSameRadiusShare = 0.1;

// What lies around a ring, bin by bin of the angle about the nozzle.
struct Support {
  std::array<std::uint16_t, RingFinder::kBins> shell_outside{};
  std::array<std::uint16_t, RingFinder::kBins> nozzle_above{};
  std::array<std::uint16_t, RingFinder::kBins> nozzle_below{};
};

int bin_of(double phi_rad) noexcept {
  const double turn = phi_rad / kTurnRad;
  const int bin = static_cast<int>((turn - std::floor(turn)) * RingFinder::kBins);
  return std::clamp(bin, 0, RingFinder::kBins - 1);
}

// A cell without a normal holds a bit of both surfaces: at a joint that speaks for it.
bool lies_along(const Eigen::Vector3d& normal, const Cell& cell, double cosine) noexcept {
  return cell.normal.squaredNorm() == 0.0 || std::abs(normal.dot(cell.normal)) > cosine;
}

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

Support support_of(std::span<const Cell> cells, const Joint& joint, const NozzleFrame& frame,
                   const CellScale& scale) noexcept {
  Support s;
  const double band = std::max(5.0 * scale.cell_mm, 15.0);
  const double tolerance_mm = scale.tolerance_mm();
  const double cosine = std::cos(kSupportRad + scale.slack_rad());
  for (const Cell& cell : cells) {
    if (shell_normal(joint, cell.mean).dot(joint.nozzle.axis) < kOtherSideCosine) {
      continue;  // Where the nozzle's axis leaves the shell on its other side.
    }
    const double above = shell_distance(joint, cell.mean);
    const double outside = signed_distance(joint.nozzle, cell.mean);
    const auto bin = static_cast<std::size_t>(bin_of(angle_about(joint.nozzle, frame, cell.mean)));
    const bool on_shell =
        std::abs(above) < tolerance_mm && outside > tolerance_mm && outside < band;
    const bool on_nozzle = std::abs(outside) < tolerance_mm && std::abs(above) > tolerance_mm &&
                           std::abs(above) < band;
    if (on_shell && lies_along(outward_normal(joint.shell, cell.mean), cell, cosine)) {
      ++s.shell_outside[bin];
    } else if (on_nozzle && lies_along(outward_normal(joint.nozzle, cell.mean), cell, cosine)) {
      ++(above > 0.0 ? s.nozzle_above : s.nozzle_below)[bin];
    }
  }
  return s;
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

bool is_bore_of(const RingCandidate& inner, const RingCandidate& outer) noexcept {
  const double wall = outer.radius_mm - inner.radius_mm;
  return wall > kMinWallMm && wall < kMaxWallShare * outer.radius_mm && is_coaxial(inner, outer);
}

// A large ring is seldom backed all round by chance, but easily along a long stretch.
double merit_of(const RingCandidate& ring) noexcept { return ring.score_mm * ring.coverage; }

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

RingFinder::Choice RingFinder::run(std::span<const Cell> cells,
                                   std::span<const FoundSurface> surfaces, const CellScale& scale,
                                   const RingHint& hint, SeamReport& report) noexcept {
  rings_.clear();
  joints_.clear();
  for (const FoundSurface& nozzle : surfaces) {
    const SurfaceKind kind = nozzle.surface.kind;
    if (kind != SurfaceKind::kCylinder && kind != SurfaceKind::kCone) {
      continue;
    }
    for (const FoundSurface& shell : surfaces) {
      if (&shell == &nozzle) {
        continue;
      }
      Joint joint{shell.surface, nozzle.surface};
      consider(cells, joint, scale, hint);
      joint.nozzle.axis = -joint.nozzle.axis;
      joint.nozzle.slope = -joint.nozzle.slope;
      consider(cells, joint, scale, hint);
    }
  }
  return choose(report);
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
  const Support support = support_of(cells, joint, frame, scale);
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
  return std::ranges::any_of(rings_.view(), [&](const RingCandidate& other) {
    return is_bore_of(ring, other) && other.fate == RingFate::kOutscored &&
           kOutside * merit_of(other) > merit_of(ring);
  });
}

// The largest of them: what lies nearer to it than to the nozzle is not the nozzle's outside.
std::optional<Surface> RingFinder::bore_of(std::size_t chosen) const noexcept {
  std::size_t best = chosen;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    const bool larger = best == chosen || rings_[i].radius_mm > rings_[best].radius_mm;
    if (is_bore_of(rings_[i], rings_[chosen]) && larger) {
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
