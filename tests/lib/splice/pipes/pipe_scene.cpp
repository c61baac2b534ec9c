// SPDX-License-Identifier: Apache-2.0
#include "pipe_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <optional>

#include "dseam/splice/pipes/pipe_finder.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace dseam::test {
namespace {

constexpr std::uint32_t kBlock = splice::PatchField::kBlockPx;
constexpr double kMinFacing = 0.25;

struct Hit {
  double z = 1e9;
  std::size_t surface = 0;
  double facing = 0.0;
};

// The ray's entry into a cylinder of the radius; none where it passes by.
std::optional<double> entry(const geometry::Cylinder& c, double radius, const Eigen::Vector3d& from,
                            const Eigen::Vector3d& ray) {
  const Eigen::Vector3d o = c.axis.cross(from - c.point_mm);
  const Eigen::Vector3d d = c.axis.cross(ray);
  const double b = o.dot(d);
  const double discriminant = b * b - d.squaredNorm() * (o.squaredNorm() - radius * radius);
  if (discriminant <= 0.0) {
    return std::nullopt;
  }
  return (-b - std::sqrt(discriminant)) / d.squaredNorm();
}

void meet(const ScenePipe& pipe, std::size_t surface, const Eigen::Vector3d& from,
          const Eigen::Vector3d& ray, Hit& nearest) {
  const geometry::Cylinder& c = pipe.cylinder;
  Eigen::Vector3d e1;
  Eigen::Vector3d e2;
  geometry::orthonormal_base(c.axis, e1, e2);
  double radius = c.radius_mm;
  std::optional<double> z;
  for (int i = 0; i < (pipe.ovality_mm > 0.0 ? 8 : 1); ++i) {
    z = entry(c, radius, from, ray);
    if (!z) {
      return;
    }
    const Eigen::Vector3d p = from + *z * ray - c.point_mm;
    radius = c.radius_mm + pipe.ovality_mm * std::cos(2.0 * std::atan2(p.dot(e2), p.dot(e1)));
  }
  const Eigen::Vector3d p = from + *z * ray;
  const double along = c.axis.dot(p - c.point_mm);
  if (*z < nearest.z && along > pipe.from_mm && along < pipe.to_mm) {
    nearest = {*z, surface, -c.normal(p).dot(ray.normalized())};
  }
}

Hit cast(const PipeScene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  Hit nearest;
  for (std::size_t i = 0; i < scene.pipes.size(); ++i) {
    meet(scene.pipes[i], i + 1, from, ray, nearest);
  }
  const double z = (60.0 - from.z()) / ray.z();
  if (scene.plate && z > 0.0 && z < nearest.z) {
    nearest = {z, 99, std::abs(ray.z()) / ray.norm()};
  }
  return nearest;
}

// The quadratic through a block's 25 rays; no patch where they meet two surfaces, or a steep one.
splice::SurfacePatch patch_at(const PipeScene& scene, const geometry::RigidTransform& T,
                              const depth::Intrinsics& k, const Eigen::Vector2d& centre) {
  Eigen::Matrix<double, 25, 6> rows;
  Eigen::Matrix<double, 25, 1> depths;
  std::size_t surface = 0;
  for (int i = 0; i < 25; ++i) {
    const Eigen::Vector2d at(0.45 * (i % 5 - 2), 0.45 * (i / 5 - 2));
    const Eigen::Vector2d px = centre + at * (kBlock / 2.0);
    const Eigen::Vector3d ray((px.x() - k.cx) / k.fx, (px.y() - k.cy) / k.fy, 1.0);
    const Hit hit = cast(scene, T.translation_mm, T.rotation * ray);
    if (hit.surface == 0 || hit.facing < kMinFacing || (i > 0 && hit.surface != surface)) {
      return {};
    }
    surface = hit.surface;
    depths(i) = hit.z;
    rows.row(i) << 1.0, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y();
  }
  const Eigen::Matrix<double, 6, 1> q = rows.colPivHouseholderQr().solve(depths);
  constexpr double kSmoothMm = 0.015;  // What curves more is no patch in a real view either.
  if ((rows * q - depths).cwiseAbs().maxCoeff() > kSmoothMm) {
    return {};
  }
  splice::SurfacePatch patch;
  Eigen::Map<Eigen::Matrix<float, 6, 1>>(patch.q.data()) = q.cast<float>();
  patch.num_pixels = kBlock * kBlock;
  patch.rms_mm = 0.02F;
  return patch;
}

double gauss(Pcg32& random) {
  const double u = 1.0 - random.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * random.uniform());
}

}  // namespace

ScenePipe shell_of(double radius_mm) {
  return {{Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), radius_mm}, -160.0, 160.0};
}

ScenePipe nozzle_of(double radius_mm, double angle_rad, double eccentricity_mm, double along_mm) {
  const Eigen::Vector3d axis(std::cos(angle_rad), 0.0, std::sin(angle_rad));
  return {{{along_mm, eccentricity_mm, 0.0}, axis, radius_mm}, 0.0, 190.0};
}

geometry::RigidTransform look_from(double azimuth_rad) {
  const Eigen::Vector3d out =
      Eigen::Vector3d(std::cos(azimuth_rad), std::sin(azimuth_rad), 1.0).normalized();
  geometry::RigidTransform T_part_camera;
  const Eigen::Vector3d x = out.cross(Eigen::Vector3d::UnitZ()).normalized();
  T_part_camera.rotation << x, (-out).cross(x), -out;
  T_part_camera.translation_mm = Eigen::Vector3d(0.0, 0.0, 110.0) + 640.0 * out;
  return T_part_camera;
}

PatchView::PatchView(const PipeScene& scene, const geometry::RigidTransform& T_part_camera,
                     bool whole_size)
    : intrinsics_(whole_size ? depth::Intrinsics{1296, 966, 2073.6, 2073.6, 647.5, 482.5}
                             : depth::Intrinsics{648, 483, 1036.8, 1036.8, 323.5, 241.0}),
      patches_(splice::PatchField::size_for(intrinsics_.width, intrinsics_.height)) {
  const splice::PatchField shape = field();
  for (std::uint32_t row = 0; row < shape.rows; ++row) {
    for (std::uint32_t column = 0; column < shape.columns; ++column) {
      patches_[std::size_t{row} * shape.columns + column] =
          patch_at(scene, T_part_camera, intrinsics_, shape.centre_px(column, row));
    }
  }
}

splice::PatchField PatchView::field() const {
  return {intrinsics_, intrinsics_.width / kBlock, intrinsics_.height / kBlock, patches_};
}

PatchView PatchView::noisy(double sigma_mm, Pcg32& random) const {
  PatchView out = *this;
  for (splice::SurfacePatch& patch : out.patches_) {
    patch.q[0] += static_cast<float>(sigma_mm * gauss(random));
    patch.q[1] += static_cast<float>(0.5 * sigma_mm * gauss(random));
    patch.q[2] += static_cast<float>(0.5 * sigma_mm * gauss(random));
  }
  return out;
}

splice::PipePair find_pipes(const splice::PatchField& field) {
  ArenaOwner owner(splice::PipeFinder::bytes());
  auto finder = splice::PipeFinder::make({}, owner.arena());
  const AllocationCounter allocations;
  const splice::PipePair pair = finder.value().run(field);
  EXPECT_EQ(allocations.count(), 0U);
  return pair;
}

}  // namespace dseam::test
