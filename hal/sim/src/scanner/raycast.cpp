// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "scanner/frame.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

Paint paint_at(const Viewpoint& view, const Vector3d& p, Surface surface) {
  if (surface != Surface::kShell || view.scene.markers.empty()) {
    return Paint::kBare;
  }
  const MarkerConfig& markers = view.config.markers;
  const double beyond = view.scene.marker_distance(p) - 0.5 * markers.diameter_mm;
  if (beyond <= 0.0) {
    return Paint::kDisc;
  }
  return beyond <= markers.ring_width_mm ? Paint::kRing : Paint::kBare;
}

/// Lambert with a dull highlight, lit from beside the lens.
double luminance(const Viewpoint& view, const Vector3d& p, const Vector3d& n, double albedo,
                 Paint paint) {
  constexpr double kAmbient = 0.12;
  constexpr double kGloss = 0.12;
  constexpr double kDarkRing = 0.05;
  const Vector3d light = view.T_part_camera * Vector3d(60.0, -30.0, 0.0) - p;
  const Vector3d to_light = light.normalized();
  const double lit = kAmbient + (1.0 - kAmbient) * std::max(0.0, n.dot(to_light));
  if (paint != Paint::kBare) {
    return lit * (paint == Paint::kDisc ? view.config.markers.albedo : kDarkRing);
  }
  const Vector3d to_eye = (view.T_part_camera.translation_mm - p).normalized();
  const double mirrored = std::max(0.0, n.dot((to_light + to_eye).normalized()));
  const double squared = mirrored * mirrored;
  const double fourth = squared * squared;
  const double sixteenth = fourth * fourth * fourth * fourth;
  return albedo * lit + kGloss * sixteenth * sixteenth * sixteenth;
}

double half_angle(const Viewpoint& view, const Vector3d& axis, double u, double v) {
  double cosine = 1.0;
  for (const double du : {-0.5, 0.5}) {
    for (const double dv : {-0.5, 0.5}) {
      const Vector3d corner =
          view.ray(u + du * Tiling::kSide, v + dv * Tiling::kSide).direction.normalized();
      cosine = std::min(cosine, axis.dot(corner));
    }
  }
  return std::acos(cosine);
}

bool meets_cone(const Solid& solid, const Ray& axis, double half_angle_rad) {
  if (std::isinf(solid.bound_radius)) {
    return true;
  }
  const Vector3d to_centre = solid.bound_centre - axis.origin;
  const double along = to_centre.dot(axis.direction);
  const double off = (to_centre - along * axis.direction).norm();
  return off * std::cos(half_angle_rad) - along * std::sin(half_angle_rad) <= solid.bound_radius;
}

}  // namespace

Sample sample(const Viewpoint& view, double u, double v,
              std::span<const std::uint16_t> candidates) noexcept {
  const Ray ray = view.ray(u, v);
  const SceneHit hit = view.scene.cast(ray, candidates);
  if (!hit.any()) {
    return {};
  }
  const Vector3d p = ray.origin + hit.t * ray.direction;
  const Vector3d n = view.scene.normal(p, hit);
  Sample out;
  out.z_mm = static_cast<float>(hit.t);
  out.facing = static_cast<float>(std::abs(n.dot(ray.direction)) / ray.direction.norm());
  out.body = hit.body;
  out.surface = view.scene.surface(hit);
  out.paint = paint_at(view, p, out.surface);
  out.luminance =
      static_cast<float>(luminance(view, p, n, view.scene.bodies[hit.body].albedo, out.paint));
  return out;
}

Tiling::Tiling(const Viewpoint& view) : across_((view.intrinsics.width + kSide - 1) / kSide) {
  const std::uint32_t down = (view.intrinsics.height + kSide - 1) / kSide;
  first_.push_back(0);
  for (std::uint32_t tile = 0; tile < across_ * down; ++tile) {
    const double u = (tile % across_ + 0.5) * kSide - 0.5;
    const double v = (tile / across_ + 0.5) * kSide - 0.5;
    Ray axis = view.ray(u, v);
    axis.direction.normalize();
    const double angle = half_angle(view, axis.direction, u, v);
    for (std::size_t i = 0; i < view.scene.bodies.size(); ++i) {
      if (meets_cone(view.scene.bodies[i].solid, axis, angle)) {
        bodies_.push_back(static_cast<std::uint16_t>(i));
      }
    }
    first_.push_back(static_cast<std::uint32_t>(bodies_.size()));
  }
}

std::span<const std::uint16_t> Tiling::candidates(std::uint32_t u, std::uint32_t v) const noexcept {
  const std::size_t tile = std::size_t{v / kSide} * across_ + u / kSide;
  return std::span(bodies_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
}

void cast_frame(const Viewpoint& view, const Tiling& tiling, std::vector<Sample>& samples) {
  const depth::Intrinsics& k = view.intrinsics;
  samples.resize(std::size_t{k.width} * k.height);
  for (std::uint32_t v = 0; v < k.height; ++v) {
    for (std::uint32_t u = 0; u < k.width; ++u) {
      samples[std::size_t{v} * k.width + u] = sample(view, u, v, tiling.candidates(u, v));
    }
  }
}

}  // namespace dseam::hal::sim
