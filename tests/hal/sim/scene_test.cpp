// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/hal/sim/cell.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

struct NamedConfig {
  const char* name;
  CellConfig config;
};

CellConfig with(JointKind kind, ShellKind shell, double axis_angle_deg, double gap_mm) {
  CellConfig config;
  config.joint.kind = kind;
  config.joint.shell = shell;
  config.joint.axis_angle_rad = axis_angle_deg * std::numbers::pi / 180.0;
  config.joint.gap_mm = gap_mm;
  config.joint.shell_radius_mm = shell == ShellKind::kSphere ? 150.0 : 108.0;
  return config;
}

std::vector<NamedConfig> cells() {
  std::vector<NamedConfig> cells{
      {"default", {}},
      {"oblique", with(JointKind::kSetIn, ShellKind::kCylinder, 62.9, 0.0)},
      {"set on", with(JointKind::kSetOn, ShellKind::kCylinder, 75.0, 2.0)},
      {"plane", with(JointKind::kSetIn, ShellKind::kPlane, 70.0, 3.0)},
      {"sphere", with(JointKind::kSetOn, ShellKind::kSphere, 80.0, 1.0)},
      {"cone", with(JointKind::kSetIn, ShellKind::kCylinder, 85.0, 1.0)},
      {"cluttered", {}},
      {"fillet", with(JointKind::kTFillet, ShellKind::kPlane, 90.0, 0.0)}};
  cells[5].config.joint.nozzle_taper_rad = 0.15;
  ClutterConfig& clutter = cells[6].config.clutter;
  clutter.num_clamps = 3;
  clutter.num_bolt_holes = 4;
  clutter.num_tack_welds = 4;
  clutter.num_spatter = 12;
  clutter.second_nozzle_radius_mm = 25.0;
  return cells;
}

bool inside_any(const Scene& scene, const Vector3d& p) {
  for (const Body& body : scene.bodies) {
    if (body.solid.contains(p)) {
      return true;
    }
  }
  return false;
}

/// The brute-force oracle: small steps until the point is inside something, then bisection.
double march(const Scene& scene, const Ray& ray, double to) {
  constexpr double kStep = 0.05;
  for (double t = 300.0; t < to; t += kStep) {
    if (inside_any(scene, ray.origin + t * ray.direction)) {
      double outside = t - kStep;
      for (double inside = t; inside - outside > 1e-9;) {
        const double middle = 0.5 * (inside + outside);
        const bool in = inside_any(scene, ray.origin + middle * ray.direction);
        (in ? inside : outside) = middle;
      }
      return outside;
    }
  }
  return std::numeric_limits<double>::infinity();
}

TEST(Scene, closed_form_casting_agrees_with_brute_force_marching) {
  for (const auto& [name, config] : cells()) {
    const Cell cell = Cell::make(config).value();
    const auto T_part_camera = config.T_base_part.inverse() * cell.views()[0].T_base_camera;
    Pcg32 random(7);
    for (int i = 0; i < 120; ++i) {
      const Vector3d direction(0.5 * random.uniform() - 0.25, 0.4 * random.uniform() - 0.2, 1.0);
      const Ray ray{T_part_camera.translation_mm, T_part_camera.rotation * direction};

      const double cast = cell.scene().cast(ray).t;

      const double marched = march(cell.scene(), ray, 900.0);
      // A sliver thinner than the step may be marched over, never the other way round.
      ASSERT_LE(cast, marched + 1e-6) << name;
      if (cast < 900.0 && std::abs(cast - marched) > 1e-6) {
        EXPECT_FALSE(inside_any(cell.scene(), ray.origin + (cast + 0.06) * ray.direction)) << name;
      }
    }
  }
}

TEST(Scene, normals_point_out_of_the_solid_that_was_hit) {
  for (const auto& [name, config] : cells()) {
    const Cell cell = Cell::make(config).value();
    const auto T_part_camera = config.T_base_part.inverse() * cell.views()[1].T_base_camera;
    Pcg32 random(8);
    for (int i = 0; i < 500; ++i) {
      const Vector3d direction(0.5 * random.uniform() - 0.25, 0.4 * random.uniform() - 0.2, 1.0);
      const Ray ray{T_part_camera.translation_mm, T_part_camera.rotation * direction};
      const SceneHit hit = cell.scene().cast(ray);
      if (!hit.any()) {
        continue;
      }
      const Vector3d p = ray.origin + hit.t * ray.direction;

      const Vector3d n = cell.scene().normal(p, hit);

      const Solid& solid = cell.scene().bodies[hit.body].solid;
      EXPECT_NEAR(n.norm(), 1.0, 1e-12) << name;
      EXPECT_LE(n.dot(ray.direction), 1e-9) << name;
      EXPECT_FALSE(solid.contains(p + 1e-6 * n)) << name;
    }
  }
}

TEST(Scene, markers_lie_on_the_shell_apart_from_each_other) {
  const Cell cell = Cell::make({}).value();
  const std::vector<Vector3d>& markers = cell.scene().markers;

  ASSERT_EQ(markers.size(), 18U);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    EXPECT_NEAR(std::hypot(markers[i].y(), markers[i].z() + 108.0), 108.0, 1e-9);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((markers[i] - markers[j]).norm(), 16.0);
    }
  }
}

TEST(CellConfig, a_joint_that_cannot_be_built_is_refused_with_its_reason) {
  CellConfig config;
  config.joint.eccentricity_mm = 70.0;

  EXPECT_STREQ(fault_in(config), "the nozzle does not meet the shell all round");
  EXPECT_EQ(Cell::make(config).error(), Errc::kInvalidArgument);
}

}  // namespace
}  // namespace dseam::hal::sim
