// SPDX-License-Identifier: Apache-2.0
#include "support/shapes/plate_cloud.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace dseam::test {
namespace {

using Eigen::Vector3d;

}  // namespace

PlateCloud::PlateCloud(const PlateCloudConfig& config) : config_(config), random_(config.seed) {
  const bool butt = config.kind == PlateCloudConfig::Kind::kButt;
  const double inner = std::max(butt ? 0.5 * config.gap_mm : 0.0, config.dead_band_mm);
  add_plate(false, inner, inner + config.width_mm, 1.0);
  if (butt) {
    add_plate(false, inner, inner + config.width_mm, -1.0);
    return;
  }
  const double low = std::max(config.gap_mm, config.dead_band_mm);
  add_plate(true, low, config.height_mm, 1.0);
  if (config.second_face_mm > 0.0) {
    add_plate(true, low, config.height_mm, -1.0);
    add_plate(false, config.second_face_mm, config.second_face_mm + config.width_mm, -1.0);
  }
}

void PlateCloud::add(const Vector3d& p) {
  x_.push_back(static_cast<float>(p.x()));
  y_.push_back(static_cast<float>(p.y()));
  z_.push_back(static_cast<float>(p.z()));
}

double PlateCloud::jitter() {
  return config_.spacing_mm * std::uniform_real_distribution<double>(-0.5, 0.5)(random_);
}

Vector3d PlateCloud::seam_at(double s_mm) const {
  const double r = config_.curve_radius_mm;
  return r == 0.0 ? Vector3d(s_mm, 0.0, 0.0)
                  : Vector3d(r * std::sin(s_mm / r), r * std::cos(s_mm / r) - r, 0.0);
}

double PlateCloud::distance(const Vector3d& p) const {
  const double r = config_.curve_radius_mm;
  const double across = r == 0.0 ? p.y() : std::hypot(p.x(), p.y() + r) - std::abs(r);
  const double part = 2.0 * p.x() / config_.length_mm;
  const double bow = config_.bow_mm * (1.0 - part * part);
  return std::hypot(across, p.z() + bow + 0.5 * config_.step_mm);
}

Vector3d PlateCloud::on_plate(bool standing, double s_mm, double away_mm, double side) const {
  const double r = config_.curve_radius_mm;
  const Vector3d root = seam_at(s_mm);
  const Vector3d outward =
      r == 0.0 ? Vector3d::UnitY() : Vector3d(std::sin(s_mm / r), std::cos(s_mm / r), 0.0);
  if (standing) {
    const double behind = side < 0.0 ? -config_.second_face_mm : 0.0;
    return root + (behind + away_mm * std::sin(config_.lean_rad)) * outward +
           away_mm * std::cos(config_.lean_rad) * Vector3d::UnitZ();
  }
  const double part = 2.0 * root.x() / config_.length_mm;
  const double bow = side > 0.0 ? -config_.bow_mm * (1.0 - part * part) : 0.0;
  const bool second = config_.kind == PlateCloudConfig::Kind::kButt && side < 0.0;
  return root + side * away_mm * outward +
         (bow - (second ? config_.step_mm : 0.0)) * Vector3d::UnitZ();
}

void PlateCloud::add_plate(bool standing, double from_mm, double to_mm, double side) {
  std::normal_distribution<double> noise(0.0, config_.noise_mm);
  const double half = 0.5 * config_.length_mm;
  const double step = config_.spacing_mm;
  for (double a = -half; a < half; a += step) {
    for (double b = from_mm; b < to_mm; b += step) {
      const double s = a + 0.5 * step + jitter();
      const double away = b + 0.5 * step + jitter();
      if (s > config_.unseen_from_mm && s < config_.unseen_to_mm) {
        continue;
      }
      const Vector3d p = on_plate(standing, s, away, side);
      const Vector3d ahead = on_plate(standing, s + 1e-3, away, side);
      const Vector3d farther = on_plate(standing, s, away + 1e-3, side);
      add(p + noise(random_) * (ahead - p).cross(farther - p).normalized());
    }
  }
}

void PlateCloud::add_box(const Vector3d& low, const Vector3d& high) {
  for (double x = low.x(); x < high.x(); x += config_.spacing_mm) {
    for (double y = low.y(); y < high.y(); y += config_.spacing_mm) {
      add({x, y, high.z()});
    }
    for (double z = low.z(); z < high.z(); z += config_.spacing_mm) {
      add({x, low.y(), z});
      add({x, high.y(), z});
    }
  }
}

void PlateCloud::transform(const Eigen::Matrix3d& rotation, const Vector3d& shift, double scale) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vector3d p = scale * (rotation * Vector3d(x_[i], y_[i], z_[i]) + shift);
    x_[i] = static_cast<float>(p.x());
    y_[i] = static_cast<float>(p.y());
    z_[i] = static_cast<float>(p.z());
  }
}

}  // namespace dseam::test
