// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "dseam/hal/sim/cell_config.hpp"
#include "shape/joint_geometry.hpp"

namespace dseam::hal::sim {
namespace {

struct Rule {
  bool holds;
  const char* fault;
};

template <std::size_t N>
const char* first_broken(const Rule (&rules)[N]) {
  for (const Rule& rule : rules) {
    if (!rule.holds) {
      return rule.fault;
    }
  }
  return nullptr;
}

const char* fault_in_joint(const JointConfig& joint) {
  constexpr double kSteepest = 0.5;  // rad; below about 30 degrees there is no joint to speak of.
  const double thinnest = joint.nozzle_radius_mm - std::abs(joint.nozzle_ovality_mm);
  const double flattest = joint.shell_radius_mm - std::abs(joint.shell_ovality_mm);
  const Rule rules[] = {
      {joint.shell_radius_mm > 0.0 && joint.shell_radius_mm < 2000.0, "shell radius: 0-2000 mm"},
      {joint.shell_wall_mm > 0.0 && joint.shell_wall_mm < flattest, "shell wall: 0 to its radius"},
      {joint.shell_length_mm > 20.0 && joint.shell_length_mm < 4000.0, "shell length: 20-4000 mm"},
      {joint.nozzle_wall_mm > 0.0 && joint.nozzle_wall_mm < thinnest, "nozzle wall: 0 to radius"},
      {joint.nozzle_height_mm > 5.0 && joint.nozzle_height_mm < 1000.0, "nozzle height: 5-1000 mm"},
      {std::abs(joint.nozzle_taper_rad) < 0.6, "nozzle taper: -0.6 to 0.6 rad"},
      {joint.axis_angle_rad > kSteepest && joint.axis_angle_rad < 3.14159265 - kSteepest,
       "axis angle: 0.5 to 2.64 rad"},
      {joint.gap_mm >= 0.0 && joint.gap_mm <= 20.0, "gap: 0-20 mm"},
      {std::hypot(joint.hole_shift_x_mm, joint.hole_shift_y_mm) <= joint.gap_mm,
       "hole shift: at most the gap"},
      {joint.nozzle_radius_mm > 0.0, "nozzle radius: above 0 mm"}};
  return first_broken(rules);
}

const char* fault_in_scanner(const ScannerConfig& scanner, const ViewConfig& views) {
  const Rule rules[] = {
      {scanner.width >= 16 && scanner.width <= 8192, "scanner width: 16-8192 pixels"},
      {scanner.height >= 16 && scanner.height <= 8192, "scanner height: 16-8192 pixels"},
      {scanner.focal_by_width > 0.1 && scanner.focal_by_width < 20.0,
       "focal length: 0.1-20 widths"},
      {scanner.mm_per_count > 0.0, "depth scale: above 0 mm"},
      {scanner.noise_mm >= 0.0, "noise: at least 0 mm"},
      {scanner.correlated_share >= 0.0 && scanner.correlated_share <= 1.0, "shares: 0 to 1"},
      {scanner.correlation_mm > 0.0, "correlation length: above 0 mm"},
      {scanner.dropout_share >= 0.0 && scanner.dropout_share <= 1.0, "shares: 0 to 1"},
      {scanner.flying_share >= 0.0 && scanner.flying_share <= 1.0, "shares: 0 to 1"},
      {scanner.unseen_share >= 0.0 && scanner.unseen_share <= 1.0, "shares: 0 to 1"},
      {scanner.dead_band_mm >= 0.0, "dead band: at least 0 mm"},
      {views.count >= 1 && views.count <= 64, "views: 1-64"},
      {views.working_distance_mm > 50.0, "working distance: above 50 mm"}};
  return first_broken(rules);
}

/// The whole ring must lie on the shell.
bool ring_exists(const JointConfig& joint) {
  constexpr int kAngles = 360;
  const Lateral hole = hole_side(joint);
  const ShellSurface shell = shell_surface(joint);
  for (int i = 0; i < kAngles; ++i) {
    const auto p = joint_point(hole, shell, 2.0 * 3.14159265358979 * i / kAngles);
    if (!p ||
        (joint.shell != ShellKind::kSphere && std::abs(p->x()) > 0.5 * joint.shell_length_mm)) {
      return false;
    }
  }
  return true;
}

}  // namespace

depth::Intrinsics intrinsics(const ScannerConfig& config) noexcept {
  const double focal = config.focal_by_width * config.width;
  return {config.width,
          config.height,
          focal,
          focal,
          0.5 * (config.width - 1.0),
          0.5 * (config.height - 1.0)};
}

const char* fault_in(const CellConfig& config) noexcept {
  if (const char* fault = fault_in_joint(config.joint)) {
    return fault;
  }
  if (const char* fault = fault_in_scanner(config.scanner, config.views)) {
    return fault;
  }
  return is_closed(config.joint.kind) && !ring_exists(config.joint)
             ? "the nozzle does not meet the shell all round"
             : nullptr;
}

}  // namespace dseam::hal::sim
