// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "dseam/seam/edge/edge_scanner.hpp"

namespace dseam::seam {
namespace {

constexpr std::size_t kMaxPixels = 8;   // Of a bevel, or of what a scanner smears.
constexpr std::size_t kLeastSteps = 2;  // Of a bevel: two pixels are always straight.
constexpr double kLeastDrop = 1.5;      // Margins that the bevel must fall over these pixels.
constexpr double kMaxBend = 0.5;        // Margins that it may bend.
constexpr double kMinRun = 0.25;        // Runs back less for each mm that it falls: a wall.
constexpr double kMaxRun = 7.0;         // Runs back more: the surface itself, bent.
constexpr double kMaxStepMm = 2.0;      // Between its first two pixels.
constexpr double kMaxScatter = 0.25;    // Of how the lines fall, of their mean.
constexpr double kShallowMm = 0.4;      // Below the margin: beyond a sharp edge most lie deeper.

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

// Of a pixel: how far it is from the other surface, and how high above this one.
std::optional<Eigen::Vector2d> EdgeScanner::place_of(const depth::DepthImage& frame,
                                                     const Step& start,
                                                     std::size_t i) const noexcept {
  const auto z_mm = double{line_[i].z_mm};
  if (!(z_mm > 0.0)) {
    return std::nullopt;
  }
  const Eigen::Vector3d p = T_base_camera_.translation_mm + z_mm * ray_base(frame, start, i);
  return Eigen::Vector2d(surface_.away(p), surface_.off(p));
}

// From the first pixel beneath to the last one that goes on straight down from it.
Eigen::Vector2d EdgeScanner::foot_of_bevel(const depth::DepthImage& frame, const Step& start,
                                           const Walk& walk,
                                           const Eigen::Vector2d& top) const noexcept {
  Eigen::Vector2d foot = top;
  std::size_t steps = 0;
  for (; steps < kMaxPixels && walk.has(walk.sure, steps + 1); ++steps) {
    const auto next = place_of(frame, start, walk.at(walk.sure, steps + 1));
    if (!next || next->y() > foot.y()) {
      break;
    }
    const Eigen::Vector2d down = *next - top;
    if (std::abs(cross(down.normalized(), foot - top)) > kMaxBend * margin_mm_ ||
        down.norm() > kMaxStepMm + 2.0 * (foot - top).norm()) {
      break;
    }
    foot = *next;
  }
  return steps < kLeastSteps ? top : foot;
}

// A bevel begins at the edge and falls slowly: its first pixels cannot be told from the surface,
// and what is seen of the edge ends too soon. The line down the bevel says where it begins.
std::optional<EdgeInterval> EdgeScanner::at_bevel(const depth::DepthImage& frame, const Step& start,
                                                  const Walk& walk,
                                                  const EdgeInterval& seen) noexcept {
  const auto top = place_of(frame, start, walk.sure);
  if (!top) {
    return std::nullopt;
  }
  const Eigen::Vector2d fall = *top - foot_of_bevel(frame, start, walk, *top);
  const double run = fall.x() / std::max(1e-9, fall.y());
  const double edge_mm = top->x() - run * top->y();
  const double beyond_mm = run * margin_mm_;
  if (!(fall.y() > kLeastDrop * margin_mm_ && run > kMinRun && run < kMaxRun &&
        edge_mm > seen.low_mm && edge_mm < seen.high_mm + beyond_mm)) {
    return std::nullopt;
  }
  shape_.runs += run;
  shape_.squares += run * run;
  return EdgeInterval{seen.phi_rad, edge_mm - 0.5 * beyond_mm, edge_mm + 0.5 * beyond_mm};
}

// The pixel after the steepest step down from the surface, on the way down.
std::size_t EdgeScanner::steepest(const depth::DepthImage& frame, const Step& start,
                                  const Walk& walk) const noexcept {
  std::size_t found = walk.sure;
  double before = 0.0;
  double largest = 0.0;
  for (std::size_t k = 1; k <= kMaxPixels && walk.has(walk.last, k + 1); ++k) {
    const auto place = place_of(frame, start, walk.at(walk.last, k));
    if (place && place->y() > before + margin_mm_) {
      break;
    }
    if (place && before - place->y() > largest) {
      largest = before - place->y();
      found = walk.at(walk.last, k + 1);
    }
    before = place ? place->y() : before;
  }
  return found;
}

// Beyond a sharp edge the next pixel lies deep. Where most go down by and by, the edge is rounded
// or bevelled in a way that the pixels do not show, or the scanner smears depths: then it is known
// no better than to lie between the surface's last pixel and the steepest place.
EdgeInterval EdgeScanner::by_shape(const depth::DepthImage& frame, const Step& start,
                                   const Walk& walk, const EdgeInterval& seen) noexcept {
  if (shape_.is_smeared) {
    const auto low = on_surface(frame, start, steepest(frame, start, walk));
    return {seen.phi_rad, low ? std::min(seen.low_mm, surface_.away(*low)) : seen.low_mm,
            seen.high_mm};
  }
  const auto edge = at_bevel(frame, start, walk, seen);
  const auto first = place_of(frame, start, walk.at(walk.last, 1));
  ++shape_.pairs;
  shape_.bevelled += edge ? 1U : 0U;
  shape_.shallow += edge || (first && first->y() > -margin_mm_ - kShallowMm) ? 1U : 0U;
  return edge && shape_.reach_mm > 0.0 ? *edge : seen;
}

// Whether the first look has shown an edge that asks for a second one, which knows its shape. All
// lines down a bevel fall alike; those down what a scanner smears do not.
bool EdgeScanner::look_again() noexcept {
  const EdgeShape first = shape_;
  const double n = std::max(1.0, static_cast<double>(first.bevelled));
  const double mean = first.runs / n;
  const double scatter = first.squares / n - mean * mean;
  const bool alike = scatter < kMaxScatter * kMaxScatter * mean * mean;
  shape_ = {};
  if (alike && 10 * first.bevelled > first.pairs) {
    shape_.reach_mm = kSurfaceShare * margin_mm_ * mean;
  } else {
    shape_.is_smeared = 3 * first.shallow > first.pairs;
  }
  return shape_.is_smeared || shape_.reach_mm > 0.0;
}

double EdgeScanner::mean_width_mm() const noexcept {
  double sum = 0.0;
  for (const EdgeInterval& interval : intervals_.view()) {
    sum += interval.high_mm - interval.low_mm;
  }
  return sum / std::max(1.0, static_cast<double>(intervals_.size()));
}

// Where the ray runs away from the other surface it may have met the wall just under the edge,
// which counts as surface down to the margin: so far past the edge may the pixel be.
double EdgeScanner::past_edge_mm(const depth::DepthImage& frame, const Step& start, std::size_t i,
                                 const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d direction = ray_base(frame, start, i);
  const double outwards = direction.dot(surface_.outwards(p));
  const double down = -direction.dot(surface_.normal(p));
  return down > 0.0 ? std::max(0.0, outwards / down) * kSurfaceShare * margin_mm_ : 0.0;
}

}  // namespace dseam::seam
