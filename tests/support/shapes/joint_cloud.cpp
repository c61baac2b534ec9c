// SPDX-License-Identifier: Apache-2.0
#include "support/shapes/joint_cloud.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace dseam::test {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;

}  // namespace

JointCloud::JointCloud(const JointCloudConfig& config) : config_(config) {
  axis_ = Vector3d(std::cos(config.axis_angle_rad), 0.0, std::sin(config.axis_angle_rad));
  u_ = Vector3d(std::sin(config.axis_angle_rad), 0.0, -std::cos(config.axis_angle_rad));
  origin_ = Vector3d(0.0, config.eccentricity_mm, 0.0);
  if (config.shell_seen) {
    add_shell();
  }
  if (config.nozzle) {
    add_nozzle();
  }
}

void JointCloud::add(const Vector3d& p) {
  x_.push_back(static_cast<float>(p.x()));
  y_.push_back(static_cast<float>(p.y()));
  z_.push_back(static_cast<float>(p.z()));
}

void JointCloud::transform(const Eigen::Matrix3d& rotation, const Vector3d& shift, double scale) {
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vector3d p = scale * (rotation * Vector3d(x_[i], y_[i], z_[i]) + shift);
    x_[i] = static_cast<float>(p.x());
    y_[i] = static_cast<float>(p.y());
    z_[i] = static_cast<float>(p.z());
  }
}

double JointCloud::shell_height(const Vector3d& p) const {
  const double r = config_.shell_radius_mm;
  switch (config_.shell) {
    case JointCloudConfig::Shell::kPlane:
      return p.z();
    case JointCloudConfig::Shell::kSphere:
      return (p - Vector3d(0.0, 0.0, -r)).norm() - r;
    case JointCloudConfig::Shell::kCylinder:
      break;
  }
  return std::hypot(p.y(), p.z() + r) - r;
}

double JointCloud::nozzle_radius(double phi_rad, double along_mm) const {
  const double a = config_.nozzle_radius_mm + config_.nozzle_ovality_mm;
  const double b = config_.nozzle_radius_mm - config_.nozzle_ovality_mm;
  const double oval = a * b / std::hypot(b * std::cos(phi_rad), a * std::sin(phi_rad));
  return oval + config_.nozzle_slope * along_mm;
}

double JointCloud::outside_nozzle(const Vector3d& p) const {
  const Vector3d q = p - origin_;
  const Vector3d v = axis_.cross(u_);
  const double radial = std::hypot(q.dot(u_), q.dot(v));
  const double radius = nozzle_radius(std::atan2(q.dot(v), q.dot(u_)), q.dot(axis_));
  return (radial - radius) / std::sqrt(1.0 + config_.nozzle_slope * config_.nozzle_slope);
}

bool JointCloud::unseen(const Vector3d& p) const {
  const Vector3d q = p - origin_;
  const double phi = std::atan2(q.dot(axis_.cross(u_)), q.dot(u_)) - config_.unseen_start_rad;
  return phi - kTurn * std::floor(phi / kTurn) < config_.unseen_width_rad;
}

void JointCloud::add_shell() {
  std::mt19937_64 random(config_.seed);
  std::normal_distribution<double> noise(0.0, config_.noise_mm);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  const double reach = config_.nozzle_radius_mm * 1.3 + config_.shell_reach_mm;
  const double r = config_.shell_radius_mm;
  const double inner = std::max(config_.gap_mm, config_.dead_band_mm);
  for (double a = -reach; a < reach; a += config_.spacing_mm) {
    for (double b = -reach; b < reach; b += config_.spacing_mm) {
      const double x = a + config_.spacing_mm * place(random);
      const double y = b + config_.spacing_mm * place(random);
      Vector3d p(x, y, 0.0);
      Vector3d n = Vector3d::UnitZ();
      if (config_.shell == JointCloudConfig::Shell::kCylinder) {
        n = Vector3d(0.0, std::sin(y / r), std::cos(y / r));
        p = Vector3d(x, 0.0, -r) + r * n;
      } else if (config_.shell == JointCloudConfig::Shell::kSphere) {
        n = Vector3d(x, y, r).normalized();
        p = Vector3d(0.0, 0.0, -r) + r * n;
      }
      const double outside = outside_nozzle(p);
      const bool behind = config_.shell == JointCloudConfig::Shell::kCylinder &&
                          std::abs(y) > 0.5 * std::numbers::pi * r;
      if (outside > inner && outside < config_.shell_reach_mm && !behind && !unseen(p)) {
        add(p + noise(random) * n);
      }
    }
  }
}

void JointCloud::add_nozzle() {
  std::mt19937_64 random(config_.seed + 1000);
  std::normal_distribution<double> noise(0.0, config_.noise_mm);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  const Vector3d v = axis_.cross(u_);
  const double low = -config_.shell_radius_mm;
  const double step = config_.spacing_mm / config_.nozzle_radius_mm;
  for (double turn = 0.0; turn < kTurn; turn += step) {
    for (double t = low; t < config_.nozzle_height_mm; t += config_.spacing_mm) {
      const double phi = turn + step * place(random);
      const double along = t + config_.spacing_mm * place(random);
      const double radius = nozzle_radius(phi, along) + noise(random);
      const Vector3d p =
          origin_ + along * axis_ + radius * (std::cos(phi) * u_ + std::sin(phi) * v);
      if (shell_height(p) > std::max(config_.dead_band_mm, config_.raised_mm) &&
          p.z() > -0.9 * config_.shell_radius_mm && !unseen(p)) {
        add(p);
      }
    }
  }
}

std::optional<Vector3d> JointCloud::curve_at(double phi_rad, double offset_mm,
                                             double height_mm) const {
  const Vector3d outward = std::cos(phi_rad) * u_ + std::sin(phi_rad) * axis_.cross(u_);
  const auto at = [&](double along) -> Vector3d {
    return origin_ + along * axis_ + (nozzle_radius(phi_rad, along) + offset_mm) * outward;
  };
  double low = -config_.shell_radius_mm;
  double high = config_.nozzle_height_mm;
  if (shell_height(at(low)) > height_mm || shell_height(at(high)) < height_mm) {
    return std::nullopt;
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (shell_height(at(middle)) > height_mm ? high : low) = middle;
  }
  return at(high);
}

std::vector<Vector3d> JointCloud::curve(std::size_t count, double offset_mm,
                                        double height_mm) const {
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto p =
        curve_at(kTurn * static_cast<double>(i) / static_cast<double>(count), offset_mm, height_mm);
    if (p) {
      points.push_back(*p);
    }
  }
  return points;
}

double distance_to(const std::vector<Vector3d>& polygon, const Vector3d& p) {
  double best = 1e300;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& a = polygon[i];
    const Vector3d d = polygon[(i + 1) % polygon.size()] - a;
    const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (p - a - t * d).norm());
  }
  return best;
}

}  // namespace dseam::test
