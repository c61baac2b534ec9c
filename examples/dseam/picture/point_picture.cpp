// SPDX-License-Identifier: Apache-2.0
#include "picture/point_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace dseam::program {
namespace {

constexpr float kEmpty = std::numeric_limits<float>::infinity();
constexpr Rgb kBackground{250, 250, 248};
constexpr int kReachPx = 5;
constexpr float kSameSurfaceMm = 6.0F;
constexpr float kDeepMm = 12.0F;  // No darker for what is deeper.
constexpr float kDarkeningPerMm = 0.055F;

std::uint8_t scaled(std::uint8_t channel, float light) {
  return static_cast<std::uint8_t>(std::clamp(static_cast<float>(channel) * light, 0.0F, 255.0F));
}

}  // namespace

Viewpoint looking_along(const Eigen::Vector3d& direction, const Eigen::Vector3d& up) {
  const Eigen::Vector3d away = direction.normalized();
  const Eigen::Vector3d right = away.cross(up).normalized();
  Viewpoint viewpoint;
  viewpoint.rotation << right.transpose(), away.cross(right).transpose(), away.transpose();
  return viewpoint;
}

PointPicture::PointPicture(const Viewpoint& viewpoint, const cloud::CloudView& cloud_base,
                           const std::vector<std::uint8_t>& tint, const std::vector<Rgb>& palette,
                           double point_radius_mm)
    : viewpoint_(viewpoint),
      image_(viewpoint.width, viewpoint.height, kBackground),
      depth_mm_(image_.pixels.size(), kEmpty),
      tint_(image_.pixels.size(), 0) {
  const double radius_px = std::clamp(point_radius_mm * viewpoint.px_per_mm, 0.8, 8.0);
  for (std::size_t i = 0; i < cloud_base.size(); ++i) {
    const geometry::Vec3f p = cloud_base[i];
    splat(viewpoint_.project({p.x, p.y, p.z}), radius_px, tint[i]);
  }
  shade(smoothed_depth(), palette);
}

bool PointPicture::hides(const Eigen::Vector3d& p_base, double margin_mm) const {
  const Eigen::Vector3d p = viewpoint_.project(p_base);
  const int u = static_cast<int>(std::floor(p.x()));
  const int v = static_cast<int>(std::floor(p.y()));
  return inside(u, v) && p.z() - static_cast<double>(depth_mm_[index(u, v)]) > margin_mm;
}

void PointPicture::splat(const Eigen::Vector3d& p_px, double radius_px, std::uint8_t tint) {
  const double limit = 2.0 * (viewpoint_.width + viewpoint_.height);
  if (!(p_px.cwiseAbs().maxCoeff() < limit)) {  // Far outside, or not a number.
    return;
  }
  const auto depth = static_cast<float>(p_px.z());
  for (int v = static_cast<int>(p_px.y() - radius_px); v <= p_px.y() + radius_px; ++v) {
    for (int u = static_cast<int>(p_px.x() - radius_px); u <= p_px.x() + radius_px; ++u) {
      const bool in_disc = std::hypot(u + 0.5 - p_px.x(), v + 0.5 - p_px.y()) <= radius_px;
      if (in_disc && inside(u, v) && depth < depth_mm_[index(u, v)]) {
        depth_mm_[index(u, v)] = depth;
        tint_[index(u, v)] = tint;
      }
    }
  }
}

std::vector<float> PointPicture::smoothed_depth() const {
  constexpr int kReach = 3;
  constexpr float kSmoothMm = 2.0F;
  std::vector<float> smooth(depth_mm_);
  for (int v = kReach; v + kReach < static_cast<int>(viewpoint_.height); ++v) {
    for (int u = kReach; u + kReach < static_cast<int>(viewpoint_.width); ++u) {
      const float here = depth_mm_[index(u, v)];
      float sum = 0.0F;
      float count = 0.0F;
      for (int k = 0; k < (2 * kReach + 1) * (2 * kReach + 1); ++k) {
        const float near =
            depth_mm_[index(u - kReach + k % (2 * kReach + 1), v - kReach + k / (2 * kReach + 1))];
        const bool same = std::abs(near - here) < kSmoothMm;  // False for an empty one.
        sum += same ? near : 0.0F;
        count += same ? 1.0F : 0.0F;
      }
      smooth[index(u, v)] = count > 0.0F ? sum / count : here;
    }
  }
  return smooth;
}

float PointPicture::lambert(const std::vector<float>& depth, int u, int v) const {
  const float here = depth[index(u, v)];
  const auto at = [&](int du, int dv) {
    const float near = depth[index(u + du, v + dv)];
    return std::abs(near - here) < kSameSurfaceMm ? near : here;
  };
  const auto mm_over_4px = static_cast<float>(4.0 / viewpoint_.px_per_mm);
  const Eigen::Vector3f normal =
      Eigen::Vector3f(at(2, 0) - at(-2, 0), at(0, 2) - at(0, -2), -mm_over_4px).normalized();
  const Eigen::Vector3f light = Eigen::Vector3f(-0.4F, -0.6F, -0.8F).normalized();
  return 0.45F + 0.65F * std::max(0.0F, normal.dot(light));
}

float PointPicture::openness(const std::vector<float>& depth, int u, int v) const {
  const float here = depth[index(u, v)];
  const auto clearance = [&](int du, int dv) {
    return std::clamp(here - depth[index(u + du, v + dv)], -kDeepMm, kDeepMm);
  };
  float occlusion_mm = 0.0F;
  for (const auto& [du, dv] : {std::pair{kReachPx, 0}, {0, kReachPx}, {3, 3}, {3, -3}}) {
    // Opposite sides cancel on a slope and add up in a crease or beside a wall.
    occlusion_mm += std::max(0.0F, clearance(du, dv) + clearance(-du, -dv));
  }
  return std::exp(-kDarkeningPerMm * occlusion_mm);
}

void PointPicture::shade(const std::vector<float>& depth, const std::vector<Rgb>& palette) {
  const int edge = kReachPx;
  for (int v = edge; v + edge < static_cast<int>(viewpoint_.height); ++v) {
    for (int u = edge; u + edge < static_cast<int>(viewpoint_.width); ++u) {
      if (depth[index(u, v)] == kEmpty) {
        continue;
      }
      const float light = lambert(depth, u, v) * openness(depth, u, v);
      const Rgb& tint = palette[tint_[index(u, v)]];
      Rgb& pixel = image_.pixels[index(u, v)];
      for (std::size_t c = 0; c < 3; ++c) {
        pixel[c] = scaled(tint[c], light);
      }
    }
  }
}

}  // namespace dseam::program
