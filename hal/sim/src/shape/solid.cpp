// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dseam::hal::sim {
namespace {

/// Rays start behind this depth; nothing real is nearer to a lens.
constexpr double kNearest = 1.0;

bool misses_bound(const Solid& solid, const Ray& ray) {
  if (std::isinf(solid.bound_radius)) {
    return false;
  }
  const Eigen::Vector3d to_centre = solid.bound_centre - ray.origin;
  const double along = to_centre.dot(ray.direction);
  const double off2 = to_centre.squaredNorm() - along * along / ray.direction.squaredNorm();
  return off2 > solid.bound_radius * solid.bound_radius;
}

}  // namespace

SolidHit Solid::cast(const Ray& ray) const noexcept {
  if (misses_bound(*this, ray)) {
    return {};
  }
  SolidHit hit{kNearest, 0, 0};
  double leave = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const Crossing crossing = keep[i].cross(ray);
    leave = std::min(leave, crossing.leave);
    if (crossing.enter > hit.t) {
      hit = {crossing.enter, static_cast<std::uint8_t>(i), crossing.enter_face};
    }
  }
  if (!(hit.t < leave)) {
    return {};
  }
  std::array<Crossing, kMaxCuts> cuts;
  const std::size_t num_cuts = std::min(cut.size(), kMaxCuts);
  for (std::size_t i = 0; i < num_cuts; ++i) {
    cuts[i] = cut[i].cross(ray);
  }
  // Each round leaves at least one cut behind for good, so there are at most num_cuts of them.
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t i = 0; i < num_cuts; ++i) {
      if (cuts[i].enter <= hit.t && hit.t < cuts[i].leave) {
        hit = {cuts[i].leave, static_cast<std::uint8_t>(keep.size() + i), cuts[i].leave_face};
        moved = true;
      }
    }
  }
  return hit.t < leave ? hit : SolidHit{};
}

Eigen::Vector3d Solid::normal(const Eigen::Vector3d& p, const SolidHit& hit) const noexcept {
  return hit.part < keep.size() ? keep[hit.part].normal(p, hit.face)
                                : Eigen::Vector3d(-cut[hit.part - keep.size()].normal(p, hit.face));
}

bool Solid::contains(const Eigen::Vector3d& p) const noexcept {
  const auto holds = [&p](const Convex& body) { return body.contains(p); };
  return std::ranges::all_of(keep, holds) && std::ranges::none_of(cut, holds);
}

}  // namespace dseam::hal::sim
