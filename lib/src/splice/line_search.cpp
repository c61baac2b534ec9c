// SPDX-License-Identifier: Apache-2.0
#include "dseam/splice/line_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dseam::splice {
namespace {

using geometry::RigidTransform;
using Points = std::span<const Eigen::Vector3d>;

struct Extent {
  double from = 1e300;
  double to = -1e300;

  [[nodiscard]] double length() const noexcept { return std::max(0.0, to - from); }
};

Extent extent_along(Points points, const RigidTransform& T_cloud_line) noexcept {
  const RigidTransform T_line_cloud = T_cloud_line.inverse();
  Extent out;
  for (const Eigen::Vector3d& p : points) {
    const double z = (T_line_cloud * p).z();
    out.from = std::min(out.from, z);
    out.to = std::max(out.to, z);
  }
  return out;
}

RigidTransform turn_about(const Eigen::Vector3d& axis, double angle_rad) noexcept {
  return {geometry::rotation_exp(axis * angle_rad), Eigen::Vector3d::Zero()};
}

}  // namespace

double largest_distance_mm(Points points, const RigidTransform& a,
                           const RigidTransform& b) noexcept {
  double largest = 0.0;
  for (const Eigen::Vector3d& p : points) {
    largest = std::max(largest, (a * p - b * p).squaredNorm());
  }
  return std::sqrt(largest);
}

void enter_candidate(Points points, const StartCandidate& candidate, double apart_mm,
                     Buffer<StartCandidate>& best) noexcept {
  if (best.full() && candidate.agreement <= best[best.size() - 1].agreement) {
    return;
  }
  const auto same = std::find_if(best.items().begin(), best.items().end(), [&](const auto& other) {
    return largest_distance_mm(points, other.T_a_b, candidate.T_a_b) < apart_mm;
  });
  if (same != best.items().end()) {
    if (same->agreement < candidate.agreement) {
      *same = candidate;
    }
  } else if (best.full()) {
    best[best.size() - 1] = candidate;
  } else {
    (void)best.append(candidate);
  }
  std::sort(best.items().begin(), best.items().end(),
            [](const auto& a, const auto& b) { return a.agreement > b.agreement; });
}

double LineSearch::agreement(const search::GridIndex& index, Points source,
                             const RigidTransform& T_a_b, double tolerance_mm,
                             double at_least) const noexcept {
  const auto reach = static_cast<float>(tolerance_mm);
  const double enough = at_least * static_cast<double>(source.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (sum + static_cast<double>(source.size() - i) < enough) {
      return 0.0;
    }
    const Eigen::Vector3f p = (T_a_b * source[i]).cast<float>();
    const search::Neighbour near = index.nearest({p.x(), p.y(), p.z()}, reach);
    if (near.index != search::kNoPoint) {
      const double share = static_cast<double>(near.squared_mm2) / (tolerance_mm * tolerance_mm);
      sum += std::max(0.0, 1.0 - share);
    }
  }
  return source.empty() ? 0.0 : sum / static_cast<double>(source.size());
}

void LineSearch::run(Points target, const search::GridIndex& index, Points source,
                     const LinePair& lines, Buffer<StartCandidate>& best) const noexcept {
  const Extent a = extent_along(target, lines.T_a_line);
  const Extent b = extent_along(source, lines.T_b_line);
  const double overlap = config_.min_overlap * std::min(a.length(), b.length());
  const auto turns = static_cast<std::uint32_t>(
      lines.any_spin ? std::ceil(2.0 * std::numbers::pi / config_.spin_step_rad) : 2.0);
  for (const bool reversed : {false, true}) {
    const RigidTransform sense =
        turn_about(Eigen::Vector3d::UnitX(), reversed ? std::numbers::pi : 0.0);
    const double low = reversed ? -b.to : b.from;
    const double high = reversed ? -b.from : b.to;
    for (std::uint32_t i = 0; i < turns; ++i) {
      const RigidTransform turn =
          turn_about(Eigen::Vector3d::UnitZ(), 2.0 * std::numbers::pi * i / turns) * sense;
      slide(source, index, lines, turn, a.from - high + overlap, a.to - low - overlap, best);
    }
  }
}

void LineSearch::slide(Points source, const search::GridIndex& index, const LinePair& lines,
                       const RigidTransform& turn, double from_mm, double to_mm,
                       Buffer<StartCandidate>& best) const noexcept {
  const double range = std::max(0.0, to_mm - from_mm);
  const double steps =
      std::min(std::ceil(range / config_.slide_step_mm), static_cast<double>(config_.max_slides));
  const RigidTransform T_line_b = lines.T_b_line.inverse();
  for (std::uint32_t i = 0; i <= static_cast<std::uint32_t>(steps); ++i) {
    const double shift = from_mm + range * i / std::max(1.0, steps);
    const RigidTransform along{Eigen::Matrix3d::Identity(), Eigen::Vector3d(0.0, 0.0, shift)};
    StartCandidate candidate{lines.T_a_line * along * turn * T_line_b, 0.0};
    const double at_least = best.full() ? best[best.size() - 1].agreement : 0.0;
    candidate.agreement = agreement(index, source, candidate.T_a_b, config_.tolerance_mm, at_least);
    if (candidate.agreement > 0.0) {
      enter_candidate(source, candidate, 2.0 * config_.tolerance_mm, best);
    }
  }
}

}  // namespace dseam::splice
