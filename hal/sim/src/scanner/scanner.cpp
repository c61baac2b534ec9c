// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/sim/scanner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "cell/random.hpp"
#include "scanner/blind_zone.hpp"
#include "scanner/frame.hpp"
#include "scanner/surface_noise.hpp"

namespace dseam::hal::sim {
namespace {

using Eigen::Vector3d;

/// Turns true samples into what the scanner reports.
class Sensor {
 public:
  Sensor(const Viewpoint& view, const Blind& blind, std::uint64_t seed)
      : view_(view),
        scanner_(view.config.scanner),
        blind_(blind),
        field_(scanner_.correlation_mm, seed),
        random_(stream(seed, Stream::kPixels)) {}

  void expose(const std::vector<Sample>& samples, Rendering& out) {
    for (std::uint32_t v = 0; v < view_.intrinsics.height; ++v) {
      for (std::uint32_t u = 0; u < view_.intrinsics.width; ++u) {
        const std::size_t i = std::size_t{v} * view_.intrinsics.width + u;
        // Every pixel draws the same numbers, so that a change of one does not move the others.
        const double white = normal(random_);
        const bool dropped = random_.uniform() < scanner_.dropout_share;
        const double flying = random_.uniform() / scanner_.flying_share;
        const double between = random_.uniform();
        const double gray_noise = scanner_.gray_noise * normal(random_);
        out.gray[i] = gray_level(samples[i], gray_noise);
        double z = static_cast<double>(samples[i].z_mm);
        if (dropped || !measurable(samples[i], u, v)) {
          out.depth[i] = 0;
          continue;
        }
        z += error_mm(u, v, z, white);
        z += flying < 1.0 ? between * edge_jump_mm(samples, u, v) : 0.0;
        out.depth[i] = count(z);
      }
    }
  }

 private:
  [[nodiscard]] static std::uint8_t gray_level(const Sample& sample, double noise) {
    constexpr double kGain = 225.0;
    const double level = kGain * static_cast<double>(sample.luminance) + noise;
    return static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0)));
  }

  [[nodiscard]] std::uint16_t count(double z_mm) const {
    const double counts = std::round(z_mm / scanner_.mm_per_count);
    const bool in_range = z_mm < scanner_.range_max_mm && counts >= 1.0 && counts <= 65535.0;
    return in_range ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
  }

  [[nodiscard]] Vector3d point(std::uint32_t u, std::uint32_t v, double z) const {
    const Ray ray = view_.ray(u, v);
    return ray.origin + z * ray.direction;
  }

  [[nodiscard]] bool measurable(const Sample& sample, std::uint32_t u, std::uint32_t v) const {
    if (sample.surface == Surface::kNothing ||
        static_cast<double>(sample.facing) < std::sin(scanner_.grazing_rad) ||
        (sample.paint != Paint::kBare && !view_.config.markers.depth_on_disc)) {
      return false;
    }
    const Vector3d p = point(u, v, static_cast<double>(sample.z_mm));
    return !blind_.covers(p) && !in_shadow(p);
  }

  [[nodiscard]] bool in_shadow(const Vector3d& p) const {
    if (scanner_.projector_baseline_mm == 0.0) {
      return false;
    }
    const Vector3d lamp = view_.T_part_camera * Vector3d(scanner_.projector_baseline_mm, 0.0, 0.0);
    const double distance = (lamp - p).norm();
    return view_.scene.cast({p, (lamp - p) / distance}).t < distance;
  }

  [[nodiscard]] double error_mm(std::uint32_t u, std::uint32_t v, double z, double white) const {
    const double share = scanner_.correlated_share;
    const double noise = std::sqrt(1.0 - share) * white +
                         (share > 0.0 ? std::sqrt(share) * field_.at(point(u, v, z)) : 0.0);
    const double x = (u - view_.intrinsics.cx) / (0.5 * view_.intrinsics.width);
    const double y = (v - view_.intrinsics.cy) / (0.5 * view_.intrinsics.height);
    return scanner_.noise_mm * noise + scanner_.bowl_mm * (0.5 * (x * x + y * y) - 0.5);
  }

  /// The largest jump to one of the four neighbours; 0 where there is no depth edge.
  [[nodiscard]] double edge_jump_mm(const std::vector<Sample>& samples, std::uint32_t u,
                                    std::uint32_t v) const {
    const std::uint32_t width = view_.intrinsics.width;
    const std::size_t i = std::size_t{v} * width + u;
    const std::array<std::size_t, 4> neighbours{u > 0 ? i - 1 : i, u + 1 < width ? i + 1 : i,
                                                v > 0 ? i - width : i,
                                                v + 1 < view_.intrinsics.height ? i + width : i};
    double jump = 0.0;
    for (const std::size_t j : neighbours) {
      const double to = static_cast<double>(samples[j].z_mm) - static_cast<double>(samples[i].z_mm);
      if (samples[j].surface != Surface::kNothing && std::abs(to) > std::abs(jump)) {
        jump = to;
      }
    }
    return std::abs(jump) > scanner_.depth_edge_mm ? jump : 0.0;
  }

  const Viewpoint& view_;
  const ScannerConfig& scanner_;
  BlindZone blind_;
  SurfaceNoise field_;
  Pcg32 random_;
};

/// Glints: a bright round spot in the image, where the scanner is dazzled.
void add_specular_spots(const Viewpoint& view, std::uint64_t seed, const std::vector<Sample>& truth,
                        Rendering& out) {
  Pcg32 random = stream(seed, Stream::kSpots);
  const std::uint32_t width = view.intrinsics.width;
  const std::uint32_t height = view.intrinsics.height;
  for (std::uint32_t n = 0; n < view.config.scanner.num_specular_spots; ++n) {
    const double radius = between(random, 2.0, 12.0);
    const auto cu = static_cast<int>(random.below(width));
    const auto cv = static_cast<int>(random.below(height));
    if (truth[static_cast<std::size_t>(cv) * width + static_cast<std::size_t>(cu)].surface ==
        Surface::kNothing) {
      continue;
    }
    const int reach = static_cast<int>(radius) + 2;
    for (int v = std::max(0, cv - reach);
         v <= std::min<int>(static_cast<int>(height) - 1, cv + reach); ++v) {
      for (int u = std::max(0, cu - reach);
           u <= std::min<int>(static_cast<int>(width) - 1, cu + reach); ++u) {
        const std::size_t i = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
        const double inside = std::clamp(radius + 0.5 - std::hypot(u - cu, v - cv), 0.0, 1.0);
        const double level = static_cast<double>(out.gray[i]);
        out.gray[i] = static_cast<std::uint8_t>(std::lround(level + inside * (255.0 - level)));
        out.depth[i] = inside > 0.5 ? std::uint16_t{0} : out.depth[i];
      }
    }
  }
}

}  // namespace

void render(const Scene& scene, const Blind& blind, const CellConfig& config,
            const geometry::RigidTransform& T_part_camera, std::uint64_t seed, Rendering& out) {
  const Viewpoint view{scene, config, intrinsics(config.scanner), T_part_camera};
  const Tiling tiling(view);
  std::vector<Sample> samples;
  cast_frame(view, tiling, samples);
  smooth_edges(view, tiling, samples);
  out.depth.resize(samples.size());
  out.gray.resize(samples.size());
  out.surface.resize(samples.size());
  out.true_z_mm.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    out.surface[i] = samples[i].surface;
    out.true_z_mm[i] = samples[i].z_mm;
  }
  Sensor(view, blind, seed).expose(samples, out);
  add_specular_spots(view, seed, samples, out);
}

depth::DepthImage image_of(const Rendering& rendering, const ScannerConfig& config) {
  return {intrinsics(config), config.mm_per_count, rendering.depth, rendering.gray};
}

}  // namespace dseam::hal::sim
