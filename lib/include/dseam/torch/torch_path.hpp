// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

namespace dseam::torch {

/// Where the contact tip's frame stands: +z along the wire towards the work, +x along travel.
///
/// Frame:   base; the origin is the wire's end (the TCP), stick-out included.
/// Units:   mm.
struct TorchPose {
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_torch = Eigen::Quaterniond::Identity();
};

/// What a stretch of path is for; the arc burns in kWeld, kOverlap and kCrater only.
enum class Segment : std::uint8_t {
  kApproach,
  kLeadIn,
  kWeld,
  kOverlap,
  kCrater,
  kLeadOut,
  kRetract,
};

/// One geometric point of the path, before it has a time.
struct PathPoint {
  TorchPose pose;
  double s_mm = 0.0;        ///< Arc length along the TCP's path from its first point.
  double speed_mm_s = 0.0;  ///< The speed asked for here.
  Segment segment = Segment::kApproach;
  bool arc = false;
  std::uint8_t pass = 0;
  std::uint8_t schedule = 0;  ///< Row of the welding parameter table.
};

using PathView = std::span<const PathPoint>;

}  // namespace dseam::torch
