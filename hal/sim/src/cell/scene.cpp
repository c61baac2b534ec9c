// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/scene.hpp"

#include <algorithm>
#include <cmath>

#include "cell/scene_parts.hpp"

namespace dseam::hal::sim {
namespace {

void keep_nearer(SceneHit& nearest, std::size_t body, const SolidHit& hit) {
  if (hit.t < nearest.t) {
    nearest = {hit.t, static_cast<std::uint16_t>(body), hit};
  }
}

}  // namespace

SceneHit Scene::cast(const Ray& ray, std::span<const std::uint16_t> candidates) const noexcept {
  SceneHit nearest;
  for (const std::uint16_t i : candidates) {
    keep_nearer(nearest, i, bodies[i].solid.cast(ray));
  }
  return nearest;
}

SceneHit Scene::cast(const Ray& ray) const noexcept {
  SceneHit nearest;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    keep_nearer(nearest, i, bodies[i].solid.cast(ray));
  }
  return nearest;
}

Surface Scene::surface(const SceneHit& hit) const noexcept {
  if (!hit.any()) {
    return Surface::kNothing;
  }
  const Body& body = bodies[hit.body];
  const bool outside = hit.on_body.part == 0 && hit.on_body.face == body.outer_face;
  return outside ? body.outside : body.inside;
}

Eigen::Vector3d Scene::normal(const Eigen::Vector3d& p, const SceneHit& hit) const noexcept {
  return bodies[hit.body].solid.normal(p, hit.on_body);
}

double Scene::marker_distance(const Eigen::Vector3d& p) const noexcept {
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& centre : markers) {
    nearest2 = std::min(nearest2, (p - centre).squaredNorm());
  }
  return std::sqrt(nearest2);
}

Scene make_scene(const CellConfig& config) {
  Scene scene;
  add_workpiece(config, scene);
  add_clutter(config, scene);
  add_markers(config, scene);
  return scene;
}

}  // namespace dseam::hal::sim
