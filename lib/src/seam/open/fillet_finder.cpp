// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/fillet_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr double kWideMm = 30.0;        // So wide a side counts in full.
constexpr double kBandMm = 15.0;        // Of cells beside the seam.
constexpr double kTouchingCells = 2.5;  // Within this both sides must begin.
constexpr double kUnseenMm = 60.0;      // A longer stretch without cells ends the walk.
constexpr std::size_t kMinCells = 8;
constexpr double kMinLengthMm = 20.0;
constexpr std::size_t kClosedSteps = 8;

// Where the cells of a side lie against the other surface: the sign of those next to it.
double sign_of_side(double positive, double negative) noexcept {
  return positive >= negative ? 1.0 : -1.0;
}

}  // namespace

void FilletFinder::run(std::span<const Cell> cells, std::span<const FoundSurface> surfaces,
                       const Scale& scale, const RingHint& hint,
                       Buffer<OpenCandidate>& found) noexcept {
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    for (std::size_t k = i + 1; k < surfaces.size(); ++k) {
      OpenJoint joint;
      joint.surface = {surfaces[i].surface, surfaces[k].surface};  // The larger one first.
      const std::optional<OpenCandidate> candidate = consider(cells, joint, scale, hint);
      if (candidate) {
        (void)found.append(*candidate);
      }
    }
  }
}

// The cells of one surface that lie beside the other, and not where both blur.
void FilletFinder::gather(std::span<const Cell> cells, const OpenJoint& joint,
                          const Scale& scale) noexcept {
  near_.clear();
  for (const Cell& cell : cells) {
    const std::array<double, 2> d{signed_distance(joint.surface[0], cell.mean),
                                  signed_distance(joint.surface[1], cell.mean)};
    for (std::size_t side = 0; side < 2; ++side) {
      if (std::abs(d[side]) < scale.tolerance_mm && std::abs(d[1 - side]) > scale.tolerance_mm &&
          std::abs(d[1 - side]) < kWideMm) {
        (void)near_.append({cell.mean, static_cast<std::uint8_t>(side), d[1 - side], cell.seen_by});
      }
    }
  }
}

// Both sides begin at the seam; a base plate may go on behind the standing one, farther off.
bool FilletFinder::choose_sides(OpenJoint& joint, const Scale& scale) noexcept {
  std::array<double, 2> positive{};
  std::array<double, 2> negative{};
  for (const NearCell& cell : near_.view()) {
    const double closeness = 1.0 / (1.0 + std::abs(cell.away_mm) / scale.cell_mm);
    (cell.away_mm > 0.0 ? positive : negative)[cell.side] += closeness * closeness;
  }
  for (std::size_t side = 0; side < 2; ++side) {
    joint.seam_sign[side] = sign_of_side(positive[side], negative[side]);
    joint.air_sign[1 - side] = joint.seam_sign[side];
  }
  std::array<std::size_t, 2> count{};
  std::array<double, 2> least{1e9, 1e9};
  std::size_t kept = 0;
  for (const NearCell& cell : near_.view()) {
    const double away = joint.seam_sign[cell.side] * cell.away_mm;
    if (away > 0.0) {
      near_[kept] = cell;
      near_[kept++].away_mm = away;
      ++count[cell.side];
      least[cell.side] = std::min(least[cell.side], away);
    }
  }
  near_.resize(kept);
  return std::min(count[0], count[1]) >= kMinCells &&
         std::max(least[0], least[1]) < kTouchingCells * scale.cell_mm;
}

// From inside a joint one sees both sides' air; from outside an edge, what lies behind them.
bool FilletFinder::is_seen_from_outside(const OpenJoint& joint,
                                        const RingHint& hint) const noexcept {
  std::size_t inside = 0;
  std::size_t outside = 0;
  for (const NearCell& cell : near_.view()) {
    for (std::size_t v = 0; v < hint.viewpoints.size(); ++v) {
      if ((cell.seen_by >> v & 1U) != 0) {
        ++(joint.off(cell.side, hint.viewpoints[v]) > 0.0 ? inside : outside);
      }
    }
  }
  return outside > inside;
}

FilletFinder::Support FilletFinder::support_at(const OpenJoint& joint, const SeamTrack::Station& at,
                                               double step_mm) const noexcept {
  std::array<bool, 2> seen{};
  const Eigen::Vector3d tangent = meeting_direction(joint.surface[0], joint.surface[1], at.p);
  for (const NearCell& cell : near_.view()) {
    const Eigen::Vector3d between = cell.mean - at.p;
    if (std::abs(tangent.dot(between)) < 0.75 * step_mm &&
        between.squaredNorm() < kBandMm * kBandMm) {
      seen[cell.side] = true;
    }
  }
  return {seen[0] && seen[1], seen[0] || seen[1]};
}

// On the line, beside the cell that is nearest to it.
std::optional<Eigen::Vector3d> FilletFinder::seed(const OpenJoint& joint) const noexcept {
  const auto nearest =
      std::min_element(near_.view().begin(), near_.view().end(),
                       [](const NearCell& a, const NearCell& b) { return a.away_mm < b.away_mm; });
  return onto_both(joint.surface[0], joint.surface[1], nearest->mean);
}

// Steps on from the last station; false where the line comes back to its start.
bool FilletFinder::extend(const OpenJoint& joint, const Eigen::Vector3d& start,
                          double step_mm) noexcept {
  const auto patience = static_cast<std::size_t>(kUnseenMm / step_mm);
  std::size_t unseen = 0;
  Eigen::Vector3d direction = meeting_direction(joint.surface[0], joint.surface[1], start);
  if (track_.stations().size() > 1) {  // The second way goes on where the first began.
    const Eigen::Vector3d first_way = track_.stations()[track_.stations().size() - 2].p - start;
    direction *= direction.dot(first_way) > 0.0 ? -1.0 : 1.0;
  }
  Eigen::Vector3d p = start;
  for (std::size_t i = 0; unseen <= patience; ++i) {
    const auto next = onto_both(joint.surface[0], joint.surface[1], p + step_mm * direction);
    if (!next || (*next - p).norm() > 3.0 * step_mm || !track_.append(*next)) {
      return true;
    }
    const Eigen::Vector3d ahead = meeting_direction(joint.surface[0], joint.surface[1], *next);
    direction = ahead.dot(direction) > 0.0 ? ahead : Eigen::Vector3d(-ahead);
    p = *next;
    unseen = support_at(joint, {p, direction, 0.0}, step_mm).any ? 0 : unseen + 1;
    if (i > kClosedSteps && (p - start).norm() < 0.75 * step_mm) {
      return false;
    }
  }
  return true;
}

const SeamTrack& FilletFinder::walk(std::span<const Cell> cells, const OpenJoint& given,
                                    const Scale& scale) noexcept {
  OpenJoint joint = given;
  gather(cells, joint, scale);
  track_.clear();
  if (choose_sides(joint, scale)) {
    trace(joint, scale);
  }
  return track_;
}

// From the seed both ways, and then as far as both sides were seen.
void FilletFinder::trace(const OpenJoint& joint, const Scale& scale) noexcept {
  track_.clear();
  const auto start = seed(joint);
  if (!start || !track_.append(*start) || !extend(joint, *start, scale.cell_mm)) {
    track_.clear();
    return;
  }
  track_.reverse();
  (void)extend(joint, *start, scale.cell_mm);
  std::size_t first = track_.stations().size();
  std::size_t last = 0;
  for (std::size_t i = 0; i < track_.stations().size(); ++i) {
    if (support_at(joint, track_.stations()[i], scale.cell_mm).both) {
      first = std::min(first, i);
      last = i;
    }
  }
  if (first >= last) {
    track_.clear();
    return;
  }
  track_.trim(first, last);
  track_.finish();
}

// How wide a side is beside the seam, by the spread of its cells: the rim of a plate is no wider
// than the plate is thick.
double FilletFinder::width_of(std::size_t side) noexcept {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (const NearCell& cell : near_.view()) {
    if (cell.side == side) {
      count += 1.0;
      sum += cell.away_mm;
      squares += cell.away_mm * cell.away_mm;
    }
  }
  const double mean = sum / std::max(1.0, count);
  return std::sqrt(12.0 * std::max(0.0, squares / std::max(1.0, count) - mean * mean));
}

std::optional<OpenCandidate> FilletFinder::consider(std::span<const Cell> cells, OpenJoint joint,
                                                    const Scale& scale,
                                                    const RingHint& hint) noexcept {
  gather(cells, joint, scale);
  if (near_.empty() || !choose_sides(joint, scale) || is_seen_from_outside(joint, hint)) {
    return std::nullopt;
  }
  trace(joint, scale);
  const SeamTrack& track = track_;
  if (track.length_mm() < std::max(kMinLengthMm, 4.0 * scale.cell_mm)) {
    return std::nullopt;
  }
  OpenCandidate candidate{.joint = joint};
  double both = 0.0;
  for (const SeamTrack::Station& station : track.stations()) {
    candidate.centre += station.p / static_cast<double>(track.stations().size());
    both += support_at(joint, station, scale.cell_mm).both ? 1.0 : 0.0;
  }
  candidate.length_mm = track.length_mm();
  candidate.coverage = both / static_cast<double>(track.stations().size());
  const double width = std::min(width_of(0), width_of(1)) / (0.9 * kWideMm - scale.tolerance_mm);
  candidate.score_mm = candidate.length_mm * candidate.coverage * std::min(1.0, width);
  candidate.fate =
      contains(hint, candidate.centre) ? RingFate::kOutscored : RingFate::kOutsideRegion;
  return candidate;
}

}  // namespace dseam::seam
