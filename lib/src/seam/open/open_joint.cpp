// SPDX-License-Identifier: Apache-2.0
#include "dseam/seam/open/open_joint.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::seam {
namespace {

constexpr int kNewtonSteps = 12;
constexpr double kPlacedMm = 1e-8;
constexpr double kGoodEnoughMm = 1e-4;
constexpr double kMinSineSquared = 0.05;  // 13 degrees: flatter surfaces do not meet in a line.
constexpr std::size_t kCoarse = 8;

}  // namespace

double OpenJoint::off(std::size_t side, const Eigen::Vector3d& p) const noexcept {
  return air_sign[side] * signed_distance(surface[side], p);
}

double OpenJoint::away(std::size_t side, const Eigen::Vector3d& p) const noexcept {
  return seam_sign[side] *
         (kind == OpenKind::kButt ? across.dot(p - middle) : signed_distance(surface[1 - side], p));
}

Eigen::Vector3d OpenJoint::normal(std::size_t side, const Eigen::Vector3d& p) const noexcept {
  return air_sign[side] * outward_normal(surface[side], p);
}

// Newton with the shortest step.
std::optional<Eigen::Vector3d> onto_both(const Surface& a, const Surface& b,
                                         const Eigen::Vector3d& p) noexcept {
  Eigen::Vector3d q = p;
  double last = 1e300;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Eigen::Vector3d na = outward_normal(a, q);
    const Eigen::Vector3d nb = outward_normal(b, q);
    const double da = signed_distance(a, q);
    const double db = signed_distance(b, q);
    const double cosine = na.dot(nb);
    const double sine_squared = 1.0 - cosine * cosine;
    if (!(sine_squared > kMinSineSquared)) {
      return std::nullopt;
    }
    const Eigen::Vector3d step = ((da - cosine * db) * na + (db - cosine * da) * nb) / sine_squared;
    q -= step;
    last = step.norm();
    if (last < kPlacedMm) {
      return q;
    }
  }
  return last < kGoodEnoughMm ? std::optional(q) : std::nullopt;
}

Eigen::Vector3d meeting_direction(const Surface& a, const Surface& b,
                                  const Eigen::Vector3d& p) noexcept {
  return outward_normal(a, p).cross(outward_normal(b, p)).normalized();
}

void SeamTrack::copy(const SeamTrack& other) noexcept {
  stations_.resize(std::min(stations_.capacity(), other.stations().size()));
  std::copy_n(other.stations().begin(), stations_.size(), stations_.items().begin());
}

void SeamTrack::reverse() noexcept {
  std::reverse(stations_.items().begin(), stations_.items().end());
}

void SeamTrack::trim(std::size_t first, std::size_t last) noexcept {
  const std::size_t count = last + 1 - first;
  std::copy_n(stations_.items().begin() + static_cast<std::ptrdiff_t>(first), count,
              stations_.items().begin());
  stations_.resize(count);
}

bool SeamTrack::lay_onto(const Surface& a, const Surface& b) noexcept {
  for (Station& station : stations_.items()) {
    const auto p = onto_both(a, b, station.p);
    if (!p) {
      return false;
    }
    station.p = *p;
  }
  finish();
  return true;
}

void SeamTrack::finish() noexcept {
  const std::span<Station> all = stations_.items();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t ahead = std::min(i + 1, all.size() - 1);
    const std::size_t behind = i > 0 ? i - 1 : 0;
    const Eigen::Vector3d chord = all[ahead].p - all[behind].p;
    all[i].tangent = all.size() > 1 ? Eigen::Vector3d(chord.normalized()) : all[i].tangent;
    all[i].s_mm = i == 0 ? 0.0 : all[i - 1].s_mm + (all[i].p - all[i - 1].p).norm();
  }
}

double SeamTrack::s_of(const Eigen::Vector3d& p) const noexcept {
  const std::span<const Station> all = stations_.view();
  const auto nearest = [&](std::size_t first, std::size_t last, std::size_t step) {
    std::size_t best = first;
    for (std::size_t i = first; i < last; i += step) {
      if ((all[i].p - p).squaredNorm() < (all[best].p - p).squaredNorm()) {
        best = i;
      }
    }
    return best;
  };
  const std::size_t coarse = nearest(0, all.size(), kCoarse);
  const std::size_t first = coarse - std::min(coarse, kCoarse);
  const std::size_t best = nearest(first, std::min(coarse + kCoarse + 1, all.size()), 1);
  return all[best].s_mm + all[best].tangent.dot(p - all[best].p);
}

SeamTrack::Station SeamTrack::at(double s_mm) const noexcept {
  const std::span<const Station> all = stations_.view();
  const auto after =
      std::upper_bound(all.begin() + 1, all.end() - 1, s_mm,
                       [](double s, const Station& station) { return s < station.s_mm; });
  const Station& next = *after;
  const Station& before = *(after - 1);
  const double part = (s_mm - before.s_mm) / (next.s_mm - before.s_mm);
  const double inside = std::clamp(part, 0.0, 1.0);
  const Eigen::Vector3d tangent =
      ((1.0 - inside) * before.tangent + inside * next.tangent).normalized();
  return {before.p + part * (next.p - before.p), tangent, s_mm};
}

}  // namespace dseam::seam
