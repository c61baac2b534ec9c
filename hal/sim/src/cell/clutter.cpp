// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>

#include "cell/random.hpp"
#include "cell/scene_parts.hpp"
#include "cell/surface_place.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;

Body fixture(const Convex& part, Surface surface, double bound_radius, double albedo) {
  Body body{.solid = {}, .outside = surface, .inside = surface, .albedo = albedo};
  body.solid.keep = {part};
  body.solid.bound_centre = part.centre;
  body.solid.bound_radius = bound_radius;
  return body;
}

Convex block(Convex::Kind kind, const Place& place, const Vector3d& offset, const Vector3d& half) {
  Convex part;
  part.kind = kind;
  part.axes = place.axes;
  part.centre = place.p + place.axes * offset;
  part.half = half;
  return part;
}

void add_table(const CellConfig& config, Scene& scene) {
  const JointConfig& joint = config.joint;
  const ShellSurface shell = shell_surface(joint);
  const bool plates = shell.kind == ShellKind::kPlane || joint.kind == JointKind::kTFillet ||
                      joint.kind == JointKind::kButt;
  const double bottom = plates ? -joint.shell_wall_mm : -2.0 * shell.half_z;
  Convex slab;
  slab.half = {900.0, 900.0, 10.0};
  slab.centre.z() = bottom - config.clutter.table_below_mm - slab.half.z();
  Body table = fixture(slab, Surface::kTable, 0.0, 0.2);
  table.solid.bound_radius = std::numeric_limits<double>::infinity();
  scene.bodies.push_back(table);
}

void add_clamps(const CellConfig& config, const PlaceFinder& places, Pcg32& random, Scene& scene) {
  const double count = config.clutter.num_clamps;
  for (std::uint32_t i = 0; i < config.clutter.num_clamps; ++i) {
    const double phi = kTurn * (i + 0.6 * random.uniform()) / count;
    const auto place = places.outside_joint(phi, between(random, 28.0, 50.0));
    if (!place) {
      continue;
    }
    const Convex jaw = block(Convex::Kind::kBox, *place, {0.0, 0.0, 8.0}, {11.0, 16.0, 12.0});
    scene.bodies.push_back(fixture(jaw, Surface::kFixture, 24.0, 0.3));
    Convex screw = block(Convex::Kind::kTube, *place, {0.0, 0.0, 35.0}, {6.0, 6.0, 1.0});
    screw.low = -20.0;
    screw.high = 20.0;
    scene.bodies.push_back(fixture(screw, Surface::kFixture, 22.0, 0.35));
  }
}

void add_second_nozzle(const CellConfig& config, Scene& scene) {
  const double radius = config.clutter.second_nozzle_radius_mm;
  const auto top = shell_surface(config.joint)
                       .meet({{config.clutter.second_nozzle_x_mm, 0.0, 0.0}, Vector3d::UnitZ()});
  if (radius <= 0.0 || !top) {
    return;
  }
  Convex outer;
  outer.kind = Convex::Kind::kTube;
  outer.centre = {config.clutter.second_nozzle_x_mm, 0.0, *top};
  outer.half = {radius, radius, 1.0};
  outer.low = -radius;
  outer.high = config.clutter.second_nozzle_height_mm;
  Convex bore = outer;
  bore.half = {0.85 * radius, 0.85 * radius, 1.0};
  bore.low = -1e6;
  bore.high = 1e6;
  Body nozzle = fixture(outer, Surface::kSecondNozzle, 2.0 * radius + outer.high, 0.5);
  nozzle.solid.cut = {bore};
  scene.bodies.push_back(nozzle);
}

void add_bolt_holes(const CellConfig& config, const PlaceFinder& places, Pcg32& random,
                    Scene& scene) {
  const double radius = config.clutter.bolt_hole_radius_mm;
  const std::uint32_t count = config.clutter.num_bolt_holes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double phi = kTurn * (i + 0.5 * random.uniform()) / count;
    const auto place = places.outside_joint(phi, between(random, 22.0, 45.0));
    if (!place || scene.bodies[0].solid.cut.size() >= Solid::kMaxCuts) {
      continue;
    }
    Convex hole = block(Convex::Kind::kTube, *place, Vector3d::Zero(), {radius, radius, 1.0});
    hole.low = -2.0 * config.joint.shell_wall_mm;
    hole.high = 2.0 * config.joint.shell_wall_mm;
    scene.bodies[0].solid.cut.push_back(hole);
  }
}

void add_tack_welds(const CellConfig& config, const PlaceFinder& places, Pcg32& random,
                    Scene& scene) {
  const double r = config.clutter.tack_weld_radius_mm;
  const std::uint32_t count = config.clutter.num_tack_welds;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double phi = kTurn * (i + 0.5 * random.uniform()) / count;
    const auto place = places.on_joint(phi);
    if (place) {
      const Convex bead = block(Convex::Kind::kEllipsoid, *place, Vector3d::Zero(),
                                {r * between(random, 0.8, 1.0), r * between(random, 1.0, 1.6),
                                 r * between(random, 0.7, 1.0)});
      scene.bodies.push_back(fixture(bead, Surface::kTackWeld, 1.7 * r, 0.55));
    }
  }
}

void add_spatter(const CellConfig& config, const PlaceFinder& places, Pcg32& random, Scene& scene) {
  for (std::uint32_t i = 0; i < config.clutter.num_spatter; ++i) {
    const double phi = kTurn * random.uniform();
    const double away = between(random, 1.0, 40.0);
    const double radius = between(random, 0.4, 1.2);
    const auto place = i % 3 == 0 ? places.on_nozzle(phi, away) : places.outside_joint(phi, away);
    if (place) {
      const Convex bead =
          block(Convex::Kind::kEllipsoid, *place, Vector3d::Zero(), {radius, radius, radius});
      scene.bodies.push_back(fixture(bead, Surface::kSpatter, 1.01 * radius, 0.55));
    }
  }
}

bool is_clear(const Scene& scene, const CellConfig& config, const Place& place) {
  const double around = 0.5 * config.markers.diameter_mm + config.markers.ring_width_mm + 1.0;
  const auto covers = [&](const Body& body) {
    return (body.solid.bound_centre - place.p).norm() < body.solid.bound_radius + around &&
           !std::isinf(body.solid.bound_radius);
  };
  const auto pierces = [&](const Convex& cut) {
    const bool bolt_hole = cut.kind == Convex::Kind::kTube && cut.half.x() < 20.0;
    return bolt_hole && (cut.centre - place.p).norm() < cut.half.x() + around;
  };
  return std::ranges::none_of(scene.bodies, covers) &&
         std::ranges::none_of(scene.bodies[0].solid.cut, pierces) &&
         scene.marker_distance(place.p) >= config.markers.spacing_mm;
}

}  // namespace

void add_clutter(const CellConfig& config, Scene& scene) {
  const PlaceFinder places(config.joint);
  Pcg32 random = stream(config.seed, Stream::kClutter);
  if (config.clutter.table) {
    add_table(config, scene);
  }
  add_second_nozzle(config, scene);
  add_clamps(config, places, random, scene);
  add_bolt_holes(config, places, random, scene);
  add_tack_welds(config, places, random, scene);
  add_spatter(config, places, random, scene);
}

void add_markers(const CellConfig& config, Scene& scene) {
  constexpr int kMaxTries = 4000;
  const PlaceFinder places(config.joint);
  Pcg32 random = stream(config.seed, Stream::kMarkers);
  const MarkerConfig& markers = config.markers;
  for (int i = 0; i < kMaxTries && scene.markers.size() < markers.count; ++i) {
    const double phi = kTurn * random.uniform();
    const double distance = between(random, markers.nearest_mm, markers.farthest_mm);
    const auto place = places.outside_joint(phi, distance);
    if (place && is_clear(scene, config, *place)) {
      scene.markers.push_back(place->p);
      scene.marker_normals.push_back(place->axes.col(2));
    }
  }
}

}  // namespace dseam::hal::sim
