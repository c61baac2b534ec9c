// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>

#include "dseam/trajectory/limits.hpp"

namespace dseam::test {

/// The largest share of each limit that was used.
class LimitShares {
 public:
  explicit LimitShares(const trajectory::Limits& limits = {}) : limits_(limits) {}

  void add_speed(const Eigen::Vector3d& mm_s) { raise(speed, mm_s, limits_.speed_mm_s); }
  void add_acceleration(const Eigen::Vector3d& mm_s2) {
    raise(acceleration, mm_s2, limits_.acceleration_mm_s2);
  }
  void add_jerk(const Eigen::Vector3d& mm_s3) { raise(jerk, mm_s3, limits_.jerk_mm_s3); }
  void add_angular_speed(const Eigen::Vector3d& rad_s) {
    raise(angular_speed, rad_s, limits_.angular_speed_rad_s);
  }
  void add_angular_acceleration(const Eigen::Vector3d& rad_s2) {
    raise(angular_acceleration, rad_s2, limits_.angular_acceleration_rad_s2);
  }
  void add(const LimitShares& other) {
    speed = std::max(speed, other.speed);
    acceleration = std::max(acceleration, other.acceleration);
    jerk = std::max(jerk, other.jerk);
    angular_speed = std::max(angular_speed, other.angular_speed);
    angular_acceleration = std::max(angular_acceleration, other.angular_acceleration);
  }
  /// Notes them, and expects each to lie between the two.
  void expect_between(double least, double most) const {
    const struct {
      const char* name;
      double share;
    } all[] = {{"speed", speed},
               {"acceleration", acceleration},
               {"jerk", jerk},
               {"angular_speed", angular_speed},
               {"angular_acceleration", angular_acceleration}};
    for (const auto& limit : all) {
      testing::Test::RecordProperty(std::string("worst_") + limit.name + "_share",
                                    std::to_string(limit.share));
      EXPECT_LT(limit.share, most) << limit.name;
      EXPECT_GT(limit.share, least) << limit.name;
    }
  }

  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double angular_speed = 0.0;
  double angular_acceleration = 0.0;

 private:
  static void raise(double& share, const Eigen::Vector3d& value, double limit) {
    share = std::max(share, value.norm() / limit);
  }

  trajectory::Limits limits_;
};

}  // namespace dseam::test
