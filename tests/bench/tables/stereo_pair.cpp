// SPDX-License-Identifier: Apache-2.0
#include "tables/stereo_pair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "dseam/base/random.hpp"

namespace dseam::bench {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;

struct Octave {
  double size_mm;
  double weight;
};
constexpr std::array<Octave, 3> kStains{{{0.7, 0.4}, {2.0, 0.35}, {8.0, 0.25}}};
constexpr double kBrushedMm = 12.0;  // Length of a scratch of 0.5 mm width.
constexpr double kScratchMm = 0.5;
constexpr double kGrayNoise = 1.5;
constexpr double kLampMm = 120.0;

/// A number in [0, 1) for each corner of a lattice.
double corner(std::int64_t x, std::int64_t y, std::int64_t z) {
  auto h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
           static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^
           static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ULL;
  h = (h ^ (h >> 31U)) * 0xD6E8FEB86659FD93ULL;
  return static_cast<double>((h ^ (h >> 32U)) & 0xFFFFFFU) / 16777216.0;
}

/// Smooth between the corners.
double value_noise(const Vector3d& p) {
  const Vector3d cell = p.array().floor();
  const Vector3d t = p - cell;
  const Vector3d s = t.array() * t.array() * (3.0 - 2.0 * t.array());
  double sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    const Vector3d at(i & 1, i >> 1 & 1, i >> 2 & 1);
    const Vector3d share = at.array() * s.array() + (1.0 - at.array()) * (1.0 - s.array());
    const Vector3d c = cell + at;
    sum += share.prod() * corner(std::llround(c.x()), std::llround(c.y()), std::llround(c.z()));
  }
  return sum;
}

double texture_at(const Vector3d& p) {
  double sum = 0.0;
  for (const Octave& octave : kStains) {
    sum += octave.weight * value_noise(p / octave.size_mm);
  }
  const Vector3d brushed(p.x() / kBrushedMm, p.y() / kScratchMm, p.z() / kScratchMm);
  return 0.6 * sum + 0.4 * value_noise(brushed);
}

class Renderer {
 public:
  Renderer(const hal::sim::Cell& cell, const RigidTransform& T_part_left)
      : scene_(cell.scene()),
        k_(hal::sim::intrinsics(cell.config().scanner)),
        lamp_(T_part_left * Vector3d(-kLampMm, 0.0, 0.0)),
        random_(cell.config().seed, 91) {}

  void run(const RigidTransform& T_part_camera, std::vector<std::uint8_t>& gray,
           std::vector<float>* z_mm) {
    gray.reserve(std::size_t{k_.width} * k_.height);
    for (std::uint32_t v = 0; v < k_.height; ++v) {
      for (std::uint32_t u = 0; u < k_.width; ++u) {
        const Vector3d direction =
            T_part_camera.rotation * Vector3d((u - k_.cx) / k_.fx, (v - k_.cy) / k_.fy, 1.0);
        const hal::sim::SceneHit hit = scene_.cast({T_part_camera.translation_mm, direction});
        const double level = hit.any() ? shade(T_part_camera.translation_mm, direction, hit) : 8.0;
        const double noise =
            kGrayNoise *
            (random_.uniform() + random_.uniform() + random_.uniform() + random_.uniform() - 2.0) *
            1.73;
        gray.push_back(static_cast<std::uint8_t>(std::clamp(level + noise, 0.0, 255.0)));
        if (z_mm != nullptr) {
          z_mm->push_back(hit.any() ? static_cast<float>(hit.t) : 0.0F);
        }
      }
    }
  }

 private:
  double shade(const Vector3d& eye, const Vector3d& direction, const hal::sim::SceneHit& hit) {
    const Vector3d p = eye + hit.t * direction;
    const Vector3d n = scene_.normal(p, hit);
    const Vector3d to_lamp = (lamp_ - p).normalized();
    const Vector3d half = (to_lamp - direction.normalized()).normalized();
    const double diffuse = std::max(0.0, n.dot(to_lamp));
    const double highlight = std::pow(std::max(0.0, n.dot(half)), 40.0);
    const double albedo = scene_.bodies[hit.body].albedo;
    return 255.0 * (albedo * (0.25 + 0.75 * diffuse) * (0.5 + texture_at(p)) + 0.25 * highlight);
  }

  const hal::sim::Scene& scene_;
  depth::Intrinsics k_;
  Vector3d lamp_;
  Pcg32 random_;
};

}  // namespace

StereoPair render_stereo(const hal::sim::Cell& cell, std::size_t view, double baseline_mm) {
  const RigidTransform T_part_left =
      cell.config().T_base_part.inverse() * cell.views()[view].T_base_camera;
  RigidTransform T_part_right = T_part_left;
  T_part_right.translation_mm = T_part_left * Vector3d(baseline_mm, 0.0, 0.0);
  StereoPair pair;
  pair.width = cell.config().scanner.width;
  Renderer renderer(cell, T_part_left);
  renderer.run(T_part_left, pair.left, &pair.left_z_mm);
  renderer.run(T_part_right, pair.right, nullptr);
  return pair;
}

}  // namespace dseam::bench
