// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "cell/scene_parts.hpp"
#include "shape/joint_geometry.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

constexpr std::uint8_t kBoxTop = 5;
constexpr double kShellAlbedo = 0.45;
constexpr double kNozzleAlbedo = 0.5;

Convex box(const Vector3d& centre, const Vector3d& half) {
  Convex body;
  body.centre = centre;
  body.half = half;
  return body;
}

Convex tube(const Lateral& side, double low, double high) {
  Convex body;
  body.kind = Convex::Kind::kTube;
  body.centre = side.centre;
  body.axes = side.axes;
  body.half = {side.a, side.b, 1.0};
  body.taper = side.taper;
  body.low = low;
  body.high = high;
  return body;
}

/// The shell's full body, `offset_mm` outside its outer surface.
Convex shell_body(const JointConfig& joint, double offset_mm, double length_mm) {
  const ShellSurface surface = shell_surface(joint).grown(offset_mm);
  Convex body;
  body.centre = {0.0, 0.0, surface.centre_z};
  switch (joint.shell) {
    case ShellKind::kPlane: {
      const double half_wall = 0.5 * (joint.shell_wall_mm + offset_mm);
      return box({0.0, 0.0, surface.centre_z - half_wall},
                 {0.5 * length_mm, 0.5 * length_mm, half_wall});
    }
    case ShellKind::kSphere:
      body.kind = Convex::Kind::kEllipsoid;
      body.half.setConstant(surface.half_y);
      return body;
    case ShellKind::kCylinder:
      break;
  }
  body.kind = Convex::Kind::kTube;
  body.axes << Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX();
  body.half = {surface.half_y, surface.half_z, 1.0};
  body.low = -0.5 * length_mm;
  body.high = 0.5 * length_mm;
  return body;
}

/// The joint's lowest point along the nozzle's axis.
double lowest_on_axis(const JointConfig& joint) {
  const Lateral side = nozzle_side(joint);
  const ShellSurface shell = shell_surface(joint);
  double lowest = 0.0;
  for (int degree = 0; degree < 360; ++degree) {
    const auto p = joint_point(side, shell, degree * std::numbers::pi / 180.0);
    lowest = std::min(lowest, p ? side.axes.col(2).dot(*p - side.centre) : 0.0);
  }
  return lowest;
}

/// The depth along the nozzle's axis that is surely through the wall and no further than need be.
double depth_through_wall(const JointConfig& joint) {
  constexpr double kBelowWall = 6.0;
  const double slant = 1.0 / std::sin(joint.axis_angle_rad);
  return lowest_on_axis(joint) - 2.0 * slant * joint.shell_wall_mm - kBelowWall;
}

Lateral shrunk(Lateral side, double wall_mm) {
  side.a -= wall_mm;
  side.b -= wall_mm;
  return side;
}

Body shell(const JointConfig& joint) {
  Body body{.solid = {},
            .outside = Surface::kShell,
            .inside = Surface::kShellInside,
            .albedo = kShellAlbedo};
  body.outer_face = joint.shell == ShellKind::kPlane ? kBoxTop : std::uint8_t{0};
  body.solid.keep = {shell_body(joint, 0.0, joint.shell_length_mm)};
  if (joint.shell != ShellKind::kPlane) {
    body.solid.cut = {shell_body(joint, -joint.shell_wall_mm, 2.0 * joint.shell_length_mm)};
  }
  if (is_closed(joint.kind)) {
    const Lateral hole = joint.kind == JointKind::kSetIn
                             ? hole_side(joint)
                             : shrunk(nozzle_side(joint), joint.nozzle_wall_mm);
    body.solid.cut.push_back(tube(hole, depth_through_wall(joint), joint.nozzle_height_mm));
  }
  return body;
}

Body nozzle(const JointConfig& joint) {
  Body body{.solid = {},
            .outside = Surface::kNozzle,
            .inside = Surface::kNozzleInside,
            .albedo = kNozzleAlbedo};
  const Lateral side = nozzle_side(joint);
  const bool set_in = joint.kind == JointKind::kSetIn;
  const double depth = set_in ? depth_through_wall(joint) : lowest_on_axis(joint) - 1.0;
  body.solid.keep = {tube(side, depth, joint.nozzle_height_mm)};
  body.solid.cut = {tube(shrunk(side, joint.nozzle_wall_mm), -1e6, 1e6)};
  if (!set_in) {
    body.solid.cut.push_back(shell_body(joint, joint.gap_mm, 2.0 * joint.shell_length_mm));
  }
  return body;
}

Body plate(const Vector3d& centre, const Vector3d& half, Surface surface, std::uint8_t face) {
  Body body{.solid = {},
            .outside = surface,
            .inside = surface,
            .outer_face = face,
            .albedo = kShellAlbedo};
  if (surface == Surface::kShell) {
    body.inside = Surface::kShellInside;
  } else {
    body.inside = Surface::kNozzleInside;
  }
  body.solid.keep = {box(centre, half)};
  return body;
}

void add_t_fillet(const JointConfig& joint, Scene& scene) {
  constexpr std::uint8_t kTowardsY = 3;
  const double half_length = 0.5 * joint.shell_length_mm;
  const double half_wall = 0.5 * joint.shell_wall_mm;
  const double half_height = 0.5 * (joint.nozzle_height_mm - joint.gap_mm);
  scene.bodies.push_back(plate({0.0, 0.0, -half_wall}, {half_length, half_length, half_wall},
                               Surface::kShell, kBoxTop));
  scene.bodies.push_back(plate({0.0, -0.5 * joint.nozzle_wall_mm, joint.gap_mm + half_height},
                               {half_length, 0.5 * joint.nozzle_wall_mm, half_height},
                               Surface::kNozzle, kTowardsY));
}

void add_butt(const JointConfig& joint, Scene& scene) {
  const double half_length = 0.5 * joint.shell_length_mm;
  const double half_wall = 0.5 * joint.shell_wall_mm;
  const double half_width = 0.5 * half_length;
  const double off = 0.5 * joint.gap_mm + half_width;
  const Vector3d half(half_length, half_width, half_wall);
  scene.bodies.push_back(plate({0.0, off, -half_wall}, half, Surface::kShell, kBoxTop));
  scene.bodies.push_back(plate({0.0, -off, -half_wall}, half, Surface::kNozzle, kBoxTop));
}

}  // namespace

void add_workpiece(const CellConfig& config, Scene& scene) {
  const JointConfig& joint = config.joint;
  if (joint.kind == JointKind::kTFillet) {
    return add_t_fillet(joint, scene);
  }
  if (joint.kind == JointKind::kButt) {
    return add_butt(joint, scene);
  }
  scene.bodies.push_back(shell(joint));
  if (is_closed(joint.kind)) {
    scene.bodies.push_back(nozzle(joint));
  }
}

}  // namespace dseam::hal::sim
