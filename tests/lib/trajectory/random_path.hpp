// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "dseam/base/random.hpp"
#include "dseam/torch/torch_path.hpp"
#include "dseam/trajectory/limits.hpp"

namespace dseam::test {

inline Eigen::Vector3d random_direction(Pcg32& random) {
  Eigen::Vector3d v;
  do {
    v = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()) * 2.0 -
        Eigen::Vector3d::Ones();
  } while (v.norm() < 0.1 || v.norm() > 1.0);
  return v.normalized();
}

inline double between(Pcg32& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

/// A path nobody would ask for: corners of any angle, steps of any length, speeds that jump, turns
/// that do not belong to the way, stops in between.
inline std::vector<torch::PathPoint> random_path(Pcg32& random) {
  std::vector<torch::PathPoint> path(2 + random.below(60));
  const double roughness = random.below(4) == 0 ? 2.0 : between(random, 0.0, 0.3);
  const double turning = between(random, 0.0, 0.3);
  const double scale_mm = std::pow(10.0, between(random, -1.3, 1.0));
  const bool even = random.below(2) == 0;
  Eigen::Vector3d heading = random_direction(random);
  Eigen::Vector3d spin = random_direction(random);
  torch::PathPoint point;
  point.pose.p_base = 500.0 * random_direction(random);
  point.pose.q_base_torch = Eigen::AngleAxisd(3.0 * random.uniform(), random_direction(random));
  for (torch::PathPoint& out : path) {
    point.speed_mm_s =
        random.below(5) == 0 ? between(random, 1.0, 300.0) : std::max(1.0, point.speed_mm_s);
    point.stop = random.below(20) == 0;
    point.dwell_s = point.stop && random.below(2) == 0 ? 0.1 * random.uniform() : 0.0;
    out = point;
    const double step_mm = scale_mm * (even ? 1.0 : between(random, 0.3, 1.7));
    heading = (heading + roughness * random_direction(random)).normalized();
    spin = (spin + roughness * random_direction(random)).normalized();
    point.pose.p_base += step_mm * heading;
    point.pose.q_base_torch =
        (point.pose.q_base_torch * Eigen::AngleAxisd(turning * random.uniform(), spin))
            .normalized();
    point.s_mm += step_mm;
  }
  return path;
}

inline trajectory::Limits random_limits(Pcg32& random) {
  trajectory::Limits limits;
  limits.speed_mm_s = between(random, 10.0, 500.0);
  limits.acceleration_mm_s2 = between(random, 100.0, 5000.0);
  limits.jerk_mm_s3 = limits.acceleration_mm_s2 * between(random, 3.0, 50.0);
  limits.angular_speed_rad_s = between(random, 0.2, 5.0);
  limits.angular_acceleration_rad_s2 = between(random, 0.5, 30.0);
  return limits;
}

}  // namespace dseam::test
