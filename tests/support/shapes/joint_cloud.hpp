// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "dseam/cloud/cloud.hpp"

namespace dseam::test {

/// A nozzle on a shell as points, straight from the formulas: no rays, no frames, no `lib/` code.
///
/// Frame:   part: z up, the shell's axis along x (cylinder), its top at z = 0; the nozzle's axis
///          passes through (0, eccentricity, 0) and leans towards +x.
struct JointCloudConfig {
  enum class Shell : std::uint8_t { kCylinder, kPlane, kSphere };

  std::uint64_t seed = 1;
  Shell shell = Shell::kCylinder;
  double shell_radius_mm = 108.0;
  double nozzle_radius_mm = 59.2;
  double nozzle_slope = 0.0;       ///< Growth of the radius along the axis: a cone.
  double nozzle_ovality_mm = 0.0;  ///< Half-axes radius + o and radius - o.
  double axis_angle_rad = std::numbers::pi / 2.0;
  double eccentricity_mm = 0.0;
  double gap_mm = 0.0;            ///< Of a hole in the shell round the nozzle.
  double raised_mm = 0.0;         ///< The nozzle's end above the shell, which goes on under it.
  double dead_band_mm = 0.0;      ///< Nothing within this of the root.
  double unseen_start_rad = 0.0;  ///< Angles about the nozzle without points.
  double unseen_width_rad = 0.0;
  double shell_reach_mm = 70.0;  ///< Shell seen this far outside the nozzle.
  double nozzle_height_mm = 70.0;
  double spacing_mm = 1.0;
  double noise_mm = 0.02;
  bool nozzle = true;
  bool shell_seen = true;
};

class JointCloud {
 public:
  explicit JointCloud(const JointCloudConfig& config);

  [[nodiscard]] cloud::FusedCloudView view() const { return {{x_, y_, z_}, {}, {}}; }
  void add(const Eigen::Vector3d& p);
  /// The same cloud in another frame and unit.
  void transform(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift, double scale);

  /// The true shell edge (offset = gap), root (both 0) or nozzle edge (height = raised) at an angle
  /// about the nozzle.
  [[nodiscard]] std::optional<Eigen::Vector3d> curve_at(double phi_rad, double offset_mm,
                                                        double height_mm = 0.0) const;
  /// The same curve as a closed polygon of `count` points.
  [[nodiscard]] std::vector<Eigen::Vector3d> curve(std::size_t count, double offset_mm,
                                                   double height_mm = 0.0) const;

 private:
  [[nodiscard]] double shell_height(const Eigen::Vector3d& p) const;
  [[nodiscard]] double outside_nozzle(const Eigen::Vector3d& p) const;
  [[nodiscard]] double nozzle_radius(double phi_rad, double along_mm) const;
  [[nodiscard]] bool unseen(const Eigen::Vector3d& p) const;
  void add_shell();
  void add_nozzle();

  JointCloudConfig config_;
  Eigen::Vector3d axis_;
  Eigen::Vector3d u_;
  Eigen::Vector3d origin_;
  std::vector<float> x_, y_, z_;
};

/// Distance of a point from the closed polygon.
[[nodiscard]] double distance_to(const std::vector<Eigen::Vector3d>& polygon,
                                 const Eigen::Vector3d& p);

}  // namespace dseam::test
