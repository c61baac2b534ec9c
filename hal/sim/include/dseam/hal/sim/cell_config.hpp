// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numbers>

#include "dseam/depth/depth_image.hpp"
#include "dseam/geometry/rigid_transform.hpp"

namespace dseam::hal::sim {

enum class ShellKind : std::uint8_t { kCylinder, kPlane, kSphere };

/// How nozzle and shell meet, or which open joint stands in their place.
enum class JointKind : std::uint8_t {
  kSetIn,      ///< The nozzle goes through a hole that is `gap_mm` wider all round.
  kSetOn,      ///< The nozzle's end is cut to the shell and stands `gap_mm` above it.
  kShellOnly,  ///< No nozzle and no hole: nothing to weld.
  kTFillet,    ///< A plate standing on a plate; open seam along x.
  kButt,       ///< Two plates edge to edge, `gap_mm` apart; open seam along x.
};

/// The workpiece, in the part frame: z up, the shell's axis along x, its top line at z = 0.
/// The nozzle's axis passes through (0, eccentricity, 0) and leans towards +x.
///
/// Units:   mm and rad. An ovality o makes the semi-axes radius + o and radius - o.
struct JointConfig {
  JointKind kind = JointKind::kSetIn;
  ShellKind shell = ShellKind::kCylinder;
  double shell_radius_mm = 108.0;  ///< Cylinder and sphere.
  double shell_ovality_mm = 0.0;   ///< Cylinder only; the wider half-axis is horizontal.
  double shell_wall_mm = 8.0;      ///< Also the thickness of plates.
  double shell_length_mm = 320.0;  ///< Of the cylinder; sides of the plate.
  double nozzle_radius_mm = 59.2;
  double nozzle_ovality_mm = 0.0;
  double nozzle_ovality_angle_rad = 0.0;  ///< Of the longer half-axis, about the nozzle's axis.
  double nozzle_taper_rad = 0.0;          ///< Half-angle of a cone that narrows upwards.
  double nozzle_wall_mm = 6.0;
  double nozzle_height_mm = 80.0;  ///< Rim above the shell's top line, along the nozzle's axis.
  double axis_angle_rad = std::numbers::pi / 2.0;  ///< Nozzle's axis against the shell's.
  double eccentricity_mm = 0.0;
  double gap_mm = 2.0;
  double hole_shift_x_mm = 0.0;  ///< Hole off the nozzle's axis: a gap that varies round it.
  double hole_shift_y_mm = 0.0;
};

/// What else is in the cell. Places are drawn from the cell's seed.
struct ClutterConfig {
  bool table = true;
  double table_below_mm = 5.0;
  std::uint32_t num_clamps = 0;          ///< A jaw (box) with a screw (cylinder) on the shell.
  double second_nozzle_radius_mm = 0.0;  ///< 0: none. Upright on the shell, without a gap.
  double second_nozzle_height_mm = 40.0;
  double second_nozzle_x_mm = -115.0;
  std::uint32_t num_bolt_holes = 0;
  double bolt_hole_radius_mm = 5.0;
  std::uint32_t num_tack_welds = 0;
  double tack_weld_radius_mm = 4.0;
  std::uint32_t num_spatter = 0;  ///< Beads of 0.4 to 1.2 mm radius on shell and nozzle.
};

/// Discs stuck flush on the shell's outside, round the joint.
struct MarkerConfig {
  std::uint32_t count = 18;
  double diameter_mm = 6.0;
  double albedo = 0.95;        ///< The shell's is 0.45: below that they are dark on light.
  double ring_width_mm = 0.0;  ///< A dark ring round each disc.
  bool depth_on_disc = true;   ///< False: the scanner gives no depth there.
  double nearest_mm = 12.0;    ///< Distance of a centre from the joint, at least...
  double farthest_mm = 75.0;   ///< ...and at most.
  double spacing_mm = 16.0;    ///< Between two centres, at least.
};

/// The structured-light scanner.
///
/// Units:   standard deviations in mm along the optical axis.
struct ScannerConfig {
  std::uint32_t width = 1296;
  std::uint32_t height = 966;
  double focal_by_width = 1.6;
  double mm_per_count = 1.0 / 64.0;
  double noise_mm = 0.02;
  double correlated_share = 0.5;  ///< Of the variance.
  double correlation_mm = 8.0;    ///< Distance on the surface at which it has fallen to 1/e.
  double bowl_mm = 0.02;          ///< Depth error at the corner against that at the centre.
  double dropout_share = 0.01;
  double flying_share = 1.0 / 3.0;  ///< Of the pixels at depth edges.
  double depth_edge_mm = 2.5;       ///< Jump to a neighbour that makes a depth edge.
  double grazing_rad = 10.0 * std::numbers::pi / 180.0;
  double range_max_mm = 1000.0;
  double projector_baseline_mm = 0.0;  ///< Along the image's x: its shadows have no depth. 0: none.
  double dead_band_mm = 0.0;           ///< No depth within half of this of the joint.
  double unseen_share = 0.0;           ///< Of the seam's length, without depth in any view...
  double unseen_start = 0.25;          ///< ...from this share of it on...
  double unseen_reach_mm = 25.0;       ///< ...as far as this from the seam.
  double gray_noise = 1.0;             ///< Gray levels.
  std::uint32_t num_specular_spots = 0;  ///< Saturated spots in each view, without depth.
};

/// From where the robot looks. Camera poses lie on a cone about the joint's upward direction.
struct ViewConfig {
  std::uint32_t count = 6;
  double first_azimuth_rad = 0.0;  ///< Of the camera's place, from the part's x axis.
  double azimuth_span_rad = 2.0 * std::numbers::pi;  ///< A full turn is divided evenly.
  double tilt_rad = 45.0 * std::numbers::pi / 180.0;
  double working_distance_mm = 640.0;
  double aim_x_mm = 0.0;       ///< The point looked at, beside the seam's centre...
  double aim_above_mm = 10.0;  ///< ...and above it.
  double jitter_mm = 5.0;      ///< True poses differ from the planned ones by this much...
  double jitter_rad = 0.01;    ///< ...which the robot knows.
  double pose_error_mm = 1.0;  ///< Standard deviation of each axis of the report.
  double pose_error_rad = 0.3 * std::numbers::pi / 180.0;
};

/// Everything that can be set in the simulated cell. The same seed gives the same bits on one
/// platform.
struct CellConfig {
  std::uint64_t seed = 1;
  JointConfig joint;
  ClutterConfig clutter;
  MarkerConfig markers;
  ScannerConfig scanner;
  ViewConfig views;
  geometry::RigidTransform T_base_part{Eigen::Matrix3d::Identity(), {700.0, 80.0, 260.0}};
};

/// The scanner's pinhole camera: no distortion, the principal point in the middle.
[[nodiscard]] depth::Intrinsics intrinsics(const ScannerConfig& config) noexcept;

/// A sentence on the first value that no cell can be built from; nullptr when there is none.
[[nodiscard]] const char* fault_in(const CellConfig& config) noexcept;

}  // namespace dseam::hal::sim
