// SPDX-License-Identifier: Apache-2.0
#include "support/shapes/bevelled_plate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace dseam::test {
namespace {

using Eigen::Vector3d;

constexpr double kNothing = std::numeric_limits<double>::infinity();
constexpr double kPipeTopMm = 70.0;
constexpr double kFloorMm = -60.0;
constexpr double kMmPerCount = 1.0 / 64.0;

double round_the_axis(const Vector3d& p) { return std::hypot(p.x(), p.y()); }

double with_level(const Vector3d& o, const Vector3d& d, double z_mm) {
  return (z_mm - o.z()) / d.z();
}

/// Both places where the ray meets the cone of this radius at z = 0, which widens by `slope`.
std::pair<double, double> with_cone(const Vector3d& o, const Vector3d& d, double radius_mm,
                                    double slope) {
  const double r = radius_mm + slope * o.z();
  const double a = d.x() * d.x() + d.y() * d.y() - slope * slope * d.z() * d.z();
  const double b = o.x() * d.x() + o.y() * d.y() - slope * d.z() * r;
  const double c = o.x() * o.x() + o.y() * o.y() - r * r;
  const double root = b * b - a * c;
  if (root < 0.0 || a == 0.0) {
    return {kNothing, kNothing};
  }
  const double one = (-b - std::sqrt(root)) / a;
  const double other = (-b + std::sqrt(root)) / a;
  return {std::min(one, other), std::max(one, other)};
}

double first_hit(const BevelledPlate& plate, const Vector3d& o, const Vector3d& d) {
  double nearest = with_level(o, d, kFloorMm);
  const auto offer = [&](double t, const auto& is_there) {
    if (t > 0.0 && t < nearest && is_there(Vector3d(o + t * d))) {
      nearest = t;
    }
  };
  const auto between = [](double low, double high) {
    return [low, high](const Vector3d& p) { return p.z() >= low && p.z() <= high; };
  };
  offer(with_level(o, d, 0.0),
        [&](const Vector3d& p) { return round_the_axis(p) >= plate.edge_radius_mm(); });
  offer(with_level(o, d, kPipeTopMm),
        [&](const Vector3d& p) { return round_the_axis(p) <= plate.pipe_radius_mm; });
  offer(with_cone(o, d, plate.pipe_radius_mm, 0.0).first, between(kFloorMm, kPipeTopMm));
  offer(with_cone(o, d, plate.edge_radius_mm(), 1.0).second, between(-plate.bevel_mm, 0.0));
  offer(with_cone(o, d, plate.pipe_radius_mm + plate.gap_mm, 0.0).second,
        between(-plate.wall_mm, -plate.bevel_mm));
  return nearest;
}

geometry::RigidTransform looking_at_the_joint(double azimuth_rad) {
  constexpr double kTiltRad = 0.75;
  constexpr double kDistanceMm = 380.0;
  const Vector3d z(-std::sin(kTiltRad) * std::cos(azimuth_rad),
                   -std::sin(kTiltRad) * std::sin(azimuth_rad), -std::cos(kTiltRad));
  const Vector3d x = Vector3d::UnitZ().cross(z).normalized();
  geometry::RigidTransform T_base_camera;
  T_base_camera.rotation << x, z.cross(x), z;
  T_base_camera.translation_mm = Vector3d(0.0, 0.0, 10.0) - kDistanceMm * z;
  return T_base_camera;
}

/// z of all pixels, as the scanner smears them.
std::vector<double> depths(const BevelledPlate& plate, const depth::Intrinsics& k,
                           const geometry::RigidTransform& T_base_camera) {
  std::vector<double> sharp;
  for (std::uint32_t v = 0; v < k.height; ++v) {
    for (std::uint32_t u = 0; u < k.width; ++u) {
      const Vector3d ray((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0);
      sharp.push_back(first_hit(plate, T_base_camera.translation_mm, T_base_camera.rotation * ray));
    }
  }
  std::vector<double> smeared = sharp;
  const auto reach = static_cast<std::size_t>(plate.smear_px);
  for (std::size_t v = reach; v + reach < k.height; ++v) {
    for (std::size_t u = reach; u + reach < k.width; ++u) {
      double sum = 0.0;
      for (std::size_t y = v - reach; y <= v + reach; ++y) {
        for (std::size_t x = u - reach; x <= u + reach; ++x) {
          sum += sharp[y * k.width + x];
        }
      }
      smeared[v * k.width + u] = sum / static_cast<double>((2 * reach + 1) * (2 * reach + 1));
    }
  }
  return smeared;
}

}  // namespace

BevelledPlateScan::BevelledPlateScan(const BevelledPlate& plate) {
  constexpr int kViews = 6;
  const depth::Intrinsics k{648, 483, 1040.0, 1040.0, 323.5, 241.0};
  std::mt19937 random(7);
  std::normal_distribution<double> noise_mm(0.0, plate.noise_mm);
  for (int view = 0; view < kViews; ++view) {
    const geometry::RigidTransform T = looking_at_the_joint(2.0 * std::numbers::pi * view / kViews);
    std::vector<std::uint16_t>& depth = depth_.emplace_back();
    for (const double z_mm : depths(plate, k, T)) {
      const double counts = (z_mm + noise_mm(random)) / kMmPerCount;
      depth.push_back(static_cast<std::uint16_t>(std::clamp(counts, 0.0, 65535.0)));
    }
    poses_.push_back({true, T});
  }
  for (const std::vector<std::uint16_t>& depth : depth_) {
    frames_.push_back({k, kMmPerCount, depth, {}});
  }
}

}  // namespace dseam::test
