// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/depth/depth_image.hpp"

namespace dseam::test {

/// A disc on a plane or on a cylinder, as a camera with square pixels sees it: every pixel is the
/// mean of 24 x 24 rays where it lies on the rim. The centre's place is known in closed form.
///
/// Frame:   camera.
struct DiscScene {
  depth::Intrinsics camera{400, 100, 2073.6, 2073.6, 199.5, 49.5};
  Eigen::Vector3d centre_mm{0.6, -0.4, 640.0};
  Eigen::Vector3d normal{0.0, -0.70710678118654752, -0.70710678118654752};  ///< Towards the camera.
  double cylinder_radius_mm = 0.0;  ///< Convex, its axis along `along`; 0: a plane.
  Eigen::Vector3d along = Eigen::Vector3d::UnitX();
  double radius_mm = 3.0;
  double disc_gray = 200.0;
  double ground_gray = 95.0;
  Eigen::Vector2d shading_per_px = Eigen::Vector2d::Zero();  ///< Of both, as a share.
  Eigen::Vector2d gloss_per_px = Eigen::Vector2d::Zero();    ///< Of the ground alone, gray values.
  double gray_noise = 0.0;
  double depth_noise_mm = 0.0;
  double missing_from_u = 1e9;  ///< Beside this pixel the disc is covered: a partial disc.
  double soft_px = 0.0;         ///< Over this width gray goes over from one to the other.
  double hole_mm = 0.0;         ///< How far the depth inside lies behind the surface.
  bool depth_on_disc = true;

  /// Depth along the ray of the pixel.
  [[nodiscard]] std::optional<double> depth_at(double u, double v) const {
    const Eigen::Vector3d ray = direction(u, v);
    if (cylinder_radius_mm == 0.0) {
      return normal.dot(centre_mm) / normal.dot(ray);
    }
    const Eigen::Vector3d axis = along.normalized();
    const auto across = [&axis](const Eigen::Vector3d& p) {
      return Eigen::Vector3d(p - axis * axis.dot(p));
    };
    const Eigen::Vector3d d = across(ray);
    const Eigen::Vector3d o = across(centre_mm - cylinder_radius_mm * normal);
    const double b = d.dot(o);
    const double root = b * b - d.dot(d) * (o.dot(o) - cylinder_radius_mm * cylinder_radius_mm);
    return root < 0.0 ? std::nullopt : std::optional((b - std::sqrt(root)) / d.dot(d));
  }
  [[nodiscard]] Eigen::Vector2d centre_px() const {
    return {camera.fx * centre_mm.x() / centre_mm.z() + camera.cx,
            camera.fy * centre_mm.y() / centre_mm.z() + camera.cy};
  }
  [[nodiscard]] Eigen::Vector3d direction(double u, double v) const {
    return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0};
  }
};

/// The scene's depth and gray.
struct DiscImage {
  depth::Intrinsics camera;
  std::vector<std::uint16_t> depth;
  std::vector<std::uint8_t> gray;
  static constexpr double kMmPerCount = 1.0 / 64.0;

  explicit DiscImage(const DiscScene& scene, std::uint64_t seed = 1) : camera(scene.camera) {
    Pcg32 random(seed, 5);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
      for (std::uint32_t u = 0; u < camera.width; ++u) {
        gray.push_back(gray_of(scene, u, v, random));
        depth.push_back(count_of(scene, u, v, random));
      }
    }
  }
  [[nodiscard]] depth::DepthImage view() const { return {camera, kMmPerCount, depth, gray}; }

 private:
  static double normal_of(Pcg32& random) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
      sum += random.uniform();
    }
    return sum;
  }

  // 1 on the disc, 0 beside it.
  static double inside(const DiscScene& s, double u, double v) {
    const auto z = s.depth_at(u, v);
    if (!z || u > s.missing_from_u) {
      return 0.0;
    }
    const double beyond = (s.direction(u, v) * *z - s.centre_mm).norm() - s.radius_mm;
    if (s.soft_px == 0.0) {
      return beyond <= 0.0 ? 1.0 : 0.0;
    }
    return 0.5 * std::erfc(beyond * s.camera.fx / (*z * s.soft_px));
  }

  static bool on_rim(const DiscScene& s, double u, double v) {
    const double share = inside(s, u, v);
    for (int side = 0; side < 8; ++side) {
      const double turn = side * 0.25 * std::numbers::pi;
      if (inside(s, u + std::cos(turn), v + std::sin(turn)) != share) {
        return true;
      }
    }
    return false;
  }

  static std::uint8_t gray_of(const DiscScene& s, std::uint32_t u, std::uint32_t v, Pcg32& random) {
    const int kPerSide = on_rim(s, u, v) ? 24 : 1;
    double sum = 0.0;
    for (int i = 0; i < kPerSide; ++i) {
      for (int j = 0; j < kPerSide; ++j) {
        const Eigen::Vector2d p(u + (i + 0.5) / kPerSide - 0.5, v + (j + 0.5) / kPerSide - 0.5);
        const double share = inside(s, p.x(), p.y());
        const Eigen::Vector2d off = p - s.centre_px();
        const double ground = s.ground_gray + s.gloss_per_px.dot(off);
        sum += (share * s.disc_gray + (1.0 - share) * ground) * (1.0 + s.shading_per_px.dot(off));
      }
    }
    const double level = sum / (kPerSide * kPerSide) + s.gray_noise * normal_of(random);
    return static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0)));
  }

  static std::uint16_t count_of(const DiscScene& s, std::uint32_t u, std::uint32_t v,
                                Pcg32& random) {
    const auto z = s.depth_at(u, v);
    const double share = inside(s, u, v);
    if (!z || (!s.depth_on_disc && share > 0.5)) {
      return 0;
    }
    const double deeper = share > 0.5 ? s.hole_mm : 0.0;
    const double level = *z + deeper + s.depth_noise_mm * normal_of(random);
    return static_cast<std::uint16_t>(std::lround(level / kMmPerCount));
  }
};

}  // namespace dseam::test
