// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dseam/seam/seam_curve.hpp"

namespace dseam::torch {

/// Where the torch's frame stands: +z along the wire towards the work, +x along travel.
///
/// Frame:   base; the origin is the wire's end (the TCP), stick-out included.
/// Units:   mm.
struct TorchPose {
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_torch = Eigen::Quaterniond::Identity();
};

/// Why the torch may not weld at a point, or kYes.
enum class Weldable : std::uint8_t {
  kYes,
  kDegenerate,     ///< Normals or tangent do not span a joint.
  kDihedral,       ///< The joint is more open or more closed than the torch is set up for.
  kInterpolated,   ///< Nothing was measured here and the configuration does not allow a bridge.
  kLowConfidence,  ///< Below the confidence asked for.
  kGap,            ///< Wider than the wire can bridge.
  kNoClearance,    ///< The contact tip would touch a surface.
  kTilt,           ///< The tilt limit keeps the torch too far from its work angle.
  kTurnsTooFast,   ///< The orientation changes faster along the seam than allowed.
};
inline constexpr std::size_t kNumWeldable = 9;

/// The torch over one point of the joint, before passes and weave move it.
///
/// Frame:   base. The joint's axes are orthogonal: `tangent` along travel, `out` the bisector of
/// the
///          joint away from the root, `across` from the shell's side to the nozzle's.
struct TorchPoint {
  TorchPose pose;
  double s_mm = 0.0;  ///< Arc length from the first point, by quadrature.
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();
  Eigen::Vector3d out = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();
  double dihedral_rad = 0.0;
  double clearance_mm = 0.0;  ///< Of the contact tip to the nearer surface.
  Weldable weldable = Weldable::kDegenerate;
  seam::Confidence confidence = seam::Confidence::kNone;  ///< Of the seam here.
};

/// The torch along the whole joint, in the direction of travel and evenly spaced in arc length.
///
/// Shape:   closed curves do not repeat the first point.
struct TorchCurveView {
  std::span<const TorchPoint> points;
  double length_mm = 0.0;
  bool closed = true;
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

/// One geometric point of the path, before it has a time. What it says of speed, arc, gas, wire,
/// pass and schedule holds from here to the next point.
struct PathPoint {
  TorchPose pose;
  double s_mm = 0.0;        ///< Length of the path without its weave, from the first point.
  double speed_mm_s = 0.0;  ///< The rate of `s_mm` asked for.
  double dwell_s = 0.0;     ///< How long to stand here; only where `stop` is set.
  Segment segment = Segment::kApproach;
  bool stop = false;  ///< The torch comes to rest here, whatever the dwell.
  bool arc = false;
  bool gas = false;
  bool wire = false;
  std::uint8_t pass = 0;
  std::uint8_t schedule = 0;                              ///< Row of the welding parameter table.
  seam::Confidence confidence = seam::Confidence::kHigh;  ///< Of the seam; kHigh without arc.
};

using PathView = std::span<const PathPoint>;

}  // namespace dseam::torch
