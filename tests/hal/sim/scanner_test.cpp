// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/scanner.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "clean_cell.hpp"

namespace dseam::hal::sim {
namespace {

double depth_mm(const Rendering& r, std::size_t i) { return r.depth[i] / 64.0; }

double error_mm(const Rendering& r, std::size_t i) {
  return depth_mm(r, i) - static_cast<double>(r.true_z_mm[i]);
}

TEST(Scanner, without_errors_depth_is_the_true_depth_to_half_a_count) {
  const Rendering r = scan(clean_cell());

  for (std::size_t i = 0; i < r.depth.size(); ++i) {
    if (r.depth[i] != 0) {
      ASSERT_LE(std::abs(error_mm(r, i)), 0.5 / 64.0 + 1e-4);
    }
  }
}

TEST(Scanner, the_same_seed_gives_the_same_bits_and_another_does_not) {
  CellConfig config;
  config.scanner.width = 324;
  config.scanner.height = 242;
  const Rendering first = scan(config);
  const Rendering again = scan(config);
  const Rendering other_view = scan(config, 1);

  EXPECT_EQ(first.depth, again.depth);
  EXPECT_EQ(first.gray, again.gray);
  EXPECT_NE(first.depth, other_view.depth);
}

TEST(Scanner, noise_has_its_variance_and_half_of_it_is_correlated_over_8_mm) {
  CellConfig config = clean_cell();
  config.scanner.noise_mm = 0.1;  // Well above the count, so that quantisation does not matter.
  config.joint.shell = ShellKind::kPlane;
  config.joint.kind = JointKind::kShellOnly;
  config.joint.shell_length_mm = 1000.0;
  config.views.tilt_rad = 1e-9;
  double sum2 = 0.0;
  double near = 0.0;
  double at_8_mm = 0.0;
  std::size_t count = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    config.seed = seed;
    const Rendering r = scan(config);
    const double pixel_mm = 640.0 / (1.6 * 648.0);
    const auto apart = static_cast<std::size_t>(std::lround(8.0 / pixel_mm));
    for (std::size_t v = 0; v < 483; ++v) {
      for (std::size_t u = 0; u + apart < 648; ++u) {
        const std::size_t i = v * 648 + u;
        const double e = error_mm(r, i);
        sum2 += e * e;
        near += e * error_mm(r, i + 1);
        at_8_mm += e * error_mm(r, i + apart);
        ++count;
      }
    }
  }
  const double n = static_cast<double>(count);

  EXPECT_NEAR(std::sqrt(sum2 / n), 0.1, 0.003);
  EXPECT_NEAR(near / sum2, 0.5, 0.03);
  EXPECT_NEAR(at_8_mm / sum2, 0.5 * std::exp(-1.0), 0.04);
}

TEST(Scanner, dropouts_and_flying_pixels_have_their_shares) {
  CellConfig config = clean_cell();
  const Rendering clean = scan(config);
  config.scanner.dropout_share = 0.01;
  config.scanner.flying_share = 1.0 / 3.0;
  const Rendering r = scan(config);

  std::size_t seen = 0;
  std::size_t dropped = 0;
  std::size_t edges = 0;
  std::size_t flown = 0;
  for (std::size_t v = 1; v + 1 < 483; ++v) {
    for (std::size_t u = 1; u + 1 < 648; ++u) {
      const std::size_t i = v * 648 + u;
      if (clean.depth[i] == 0) {
        continue;
      }
      ++seen;
      dropped += r.depth[i] == 0;
      double jump = 0.0;
      for (const std::size_t j : {i - 1, i + 1, i - 648, i + 648}) {
        const double z = static_cast<double>(clean.true_z_mm[j]);
        jump =
            z > 0.0 ? std::max(jump, std::abs(z - static_cast<double>(clean.true_z_mm[i]))) : jump;
      }
      if (jump > 2.5 && r.depth[i] != 0) {
        ++edges;
        flown += r.depth[i] != clean.depth[i];
      }
      if (jump <= 2.5 && r.depth[i] != 0) {
        ASSERT_EQ(r.depth[i], clean.depth[i]);
      }
    }
  }

  EXPECT_NEAR(static_cast<double>(dropped) / static_cast<double>(seen), 0.01, 0.001);
  ASSERT_GT(edges, 1000U);
  EXPECT_NEAR(static_cast<double>(flown) / static_cast<double>(edges), 1.0 / 3.0, 0.05);
}

TEST(Scanner, the_bowl_is_as_deep_as_asked_from_centre_to_corner) {
  CellConfig config = clean_cell();
  config.scanner.bowl_mm = 0.5;
  config.joint.shell = ShellKind::kPlane;
  config.joint.kind = JointKind::kShellOnly;
  config.joint.shell_length_mm = 1000.0;
  const Rendering r = scan(config);

  const double centre = error_mm(r, 241 * 648 + 324);
  const double corner = error_mm(r, 0);

  EXPECT_NEAR(corner - centre, 0.5, 0.02);
}

TEST(Scanner, nothing_is_measured_under_the_grazing_angle_or_out_of_range) {
  CellConfig config = clean_cell();
  config.scanner.grazing_rad = 0.5;
  config.scanner.range_max_mm = 700.0;
  const Rendering r = scan(config);

  const Cell cell = Cell::make(config).value();
  const auto T_part_camera = config.T_base_part.inverse() * cell.views()[0].T_base_camera;
  const depth::Intrinsics k = intrinsics(config.scanner);
  for (std::size_t i = 0; i < r.depth.size(); i += 97) {
    const Eigen::Vector3d d((static_cast<double>(i % 648) - k.cx) / k.fx,
                            (static_cast<double>(i / 648) - k.cy) / k.fy, 1.0);
    const Ray ray{T_part_camera.translation_mm, T_part_camera.rotation * d};
    const SceneHit hit = cell.scene().cast(ray);
    if (r.depth[i] != 0) {
      const Eigen::Vector3d n = cell.scene().normal(ray.origin + hit.t * ray.direction, hit);
      ASSERT_GE(std::abs(n.dot(ray.direction.normalized())), std::sin(0.5) - 1e-6);
      ASSERT_LE(hit.t, 700.0 + 0.01);
    }
  }
}

TEST(Scanner, flush_markers_are_bright_discs_of_their_size) {
  CellConfig config = clean_cell();
  config.joint.shell = ShellKind::kPlane;
  config.joint.kind = JointKind::kShellOnly;
  config.views.tilt_rad = 1e-9;
  config.views.jitter_mm = 0.0;
  config.views.jitter_rad = 0.0;
  config.views.aim_above_mm = 0.0;
  const Cell cell = Cell::make(config).value();
  const Rendering r = scan(config);
  const depth::Intrinsics k = intrinsics(config.scanner);
  const auto T_camera_base = cell.views()[0].T_base_camera.inverse();
  const Eigen::Vector3d c = T_camera_base * cell.markers()[0];
  const double cu = k.fx * c.x() / c.z() + k.cx;
  const double cv = k.fy * c.y() / c.z() + k.cy;
  const double radius = 3.0 * k.fx / c.z();

  // The sum over the disc of what it adds to the shell's gray is its area, and its centroid the
  // disc's centre.
  const int reach = static_cast<int>(radius) + 4;
  const double shell = r.gray[static_cast<std::size_t>(std::lround(cv) - reach) * k.width +
                              static_cast<std::size_t>(std::lround(cu) - reach)];
  const double disc = r.gray[static_cast<std::size_t>(std::lround(cv)) * k.width +
                             static_cast<std::size_t>(std::lround(cu))];
  double area = 0.0;
  double sum_u = 0.0;
  double sum_v = 0.0;
  for (auto v = static_cast<int>(cv) - reach; v <= static_cast<int>(cv) + reach; ++v) {
    for (auto u = static_cast<int>(cu) - reach; u <= static_cast<int>(cu) + reach; ++u) {
      const double gray =
          r.gray[static_cast<std::size_t>(v) * k.width + static_cast<std::size_t>(u)];
      const double share = std::clamp((gray - shell) / (disc - shell), 0.0, 1.2);
      area += share > 0.05 ? share : 0.0;
      sum_u += share > 0.05 ? share * u : 0.0;
      sum_v += share > 0.05 ? share * v : 0.0;
    }
  }

  EXPECT_NEAR(area, std::numbers::pi * radius * radius, 0.05 * area);
  EXPECT_NEAR(sum_u / area, cu, 0.05);
  EXPECT_NEAR(sum_v / area, cv, 0.05);
}

TEST(CellViews, reported_poses_are_off_by_the_robots_error) {
  CellConfig config;
  config.scanner.width = 64;
  config.scanner.height = 48;
  config.views.count = 60;
  double sum2_mm = 0.0;
  double sum2_rad = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    config.seed = seed;
    const Cell cell = Cell::make(config).value();
    for (const CellView& view : cell.views()) {
      sum2_mm += (view.T_base_camera_reported.translation_mm - view.T_base_camera.translation_mm)
                     .squaredNorm();
      sum2_rad += geometry::rotation_log(view.T_base_camera_reported.rotation *
                                         view.T_base_camera.rotation.transpose())
                      .squaredNorm();
      count += 3;
    }
  }

  EXPECT_NEAR(std::sqrt(sum2_mm / count), 1.0, 0.06);
  EXPECT_NEAR(std::sqrt(sum2_rad / count), 0.3 * std::numbers::pi / 180.0, 0.0004);
}

}  // namespace
}  // namespace dseam::hal::sim
