// SPDX-License-Identifier: Apache-2.0
#include "orientation.hpp"

#include <bit>

namespace dseam::cloud {
namespace {

// The views that saw the point and whose sensor is known.
std::uint32_t views_of(const FusedCloudView& cloud, std::size_t i, std::size_t sensors) noexcept {
  const std::uint32_t known = (1U << sensors) - 1U;
  return cloud.seen_by.empty() ? known & 1U : known & cloud.seen_by[i];
}

// Positive when the sensor that sees the point most squarely is on the normal's side.
float side_of_sensor(geometry::Vec3f point, geometry::Vec3f normal, std::uint32_t views,
                     std::span<const geometry::Vec3f> sensors) noexcept {
  float best = 0.0F;
  float best_square = -1.0F;
  for (; views != 0; views &= views - 1) {
    const auto view = static_cast<std::size_t>(std::countr_zero(views));
    const geometry::Vec3f ray = sensors[view] - point;
    const float along = geometry::dot(ray, normal);
    const float square = along * along / geometry::squared_norm(ray);
    if (square > best_square) {
      best_square = square;
      best = along;
    }
  }
  return best;
}

}  // namespace

std::uint32_t orient(const FusedCloudView& cloud, std::span<const geometry::Vec3f> sensors,
                     NormalsBuffer& normals) noexcept {
  const std::span<const geometry::Vec3f> known =
      sensors.first(sensors.size() < kMaxViews ? sensors.size() : kMaxViews);
  std::uint32_t not_oriented = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (normals.state[i] != NormalState::kGood) {
      continue;
    }
    const std::uint32_t views = views_of(cloud, i, known.size());
    const geometry::Vec3f normal = normals[i];
    not_oriented += views == 0 ? 1U : 0U;
    if (views != 0 && side_of_sensor(cloud.points[i], normal, views, known) < 0.0F) {
      normals.set(i, -normal, normals.variation[i], NormalState::kGood);
    }
  }
  return not_oriented;
}

}  // namespace dseam::cloud
