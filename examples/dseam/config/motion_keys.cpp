// SPDX-License-Identifier: Apache-2.0
#include "config/key_tables.hpp"

namespace dseam::program {
namespace {

constexpr double kTurn = 2.0 * 3.14159265358979323846;

std::vector<Key> torch_keys(torch::TorchPlanner::Config& c) {
  return {
      {"torch", "reversed", &c.reversed, "Travel against the order of the seam's points"},
      {"torch", "work_fraction", &c.work_fraction,
       "Angle of the wire over the shell as a share of the dihedral", "", 0.05, 0.95},
      {"torch", "work_offset_rad", &c.work_offset_rad, "Added to it, towards the nozzle", "rad", -1,
       1},
      {"torch", "travel_angle_rad", &c.travel_angle_rad, "Positive pushes, negative drags", "rad",
       -1, 1},
      {"torch", "stick_out_mm", &c.stick_out_mm, "From the contact tip to the wire's end", "mm", 1,
       60},
      {"torch", "tip_radius_mm", &c.tip_radius_mm, "Of the contact tip", "mm", 0.5, 40},
      {"torch", "min_clearance_mm", &c.min_clearance_mm, "Of the contact tip to either surface",
       "mm", 0, 50},
      {"torch", "max_gap_mm", &c.max_gap_mm, "Not welded where the gap is wider", "mm", 0, 50},
      {"torch", "max_tilt_rad", &c.max_tilt_rad, "Of the torch from upright", "rad", 0, kTurn / 2},
      {"torch", "min_confidence", choice(c.min_confidence, {"none", "low", "medium", "high"}),
       "Not welded where the seam is less certain"},
      {"torch", "weld_interpolated", &c.weld_interpolated, "Weld stretches that were not measured"},
  };
}

std::vector<Key> path_keys(torch::PathPlanner::Config& c) {
  torch::Pass& pass = c.passes[0];
  return {
      {"path", "speed_mm_s", &pass.speed_mm_s, "Welding speed", "mm/s", 0.5, 100},
      {"path", "overlap_mm", &c.overlap_mm, "Past the start, on closed seams", "mm", 0, 500},
      {"path", "approach_mm", &c.approach_mm, "Height of approach and retract", "mm", 1, 500},
      {"path", "lead_in_mm", &c.lead_in_mm, "Slow last part of the approach", "mm", 0, 200},
      {"path", "travel_mm_s", &c.travel_mm_s, "Speed without arc", "mm/s", 1, 1000},
      {"path", "preflow_s", &c.preflow_s, "Gas before the arc", "s", 0, 10},
      {"path", "ignition_s", &c.ignition_s, "Standing at the start with the arc on", "s", 0, 10},
      {"path", "crater_s", &c.crater_s, "Standing at the end with the arc on", "s", 0, 10},
      {"path", "postflow_s", &c.postflow_s, "Gas after the arc", "s", 0, 30},
      {"path", "weave", choice(pass.weave.shape, {"none", "sine", "zig_zag", "triangle", "circle"}),
       "Motion across the seam"},
      {"path", "weave_amplitude_mm", &pass.weave.amplitude_mm, "To each side", "mm", 0, 20},
      {"path", "weave_pitch_mm", &pass.weave.pitch_mm, "Travel of one period", "mm", 0, 50},
      {"path", "max_start_mm", &c.max_start_mm, "Refused when the torch stands farther away", "mm",
       1, 10000},
      {"path", "max_wrist_turn_rad", &c.max_wrist_turn_rad, "About the wire, before it is unwound",
       "rad", 0.1, 4 * kTurn},
  };
}

std::vector<Key> limit_keys(pipeline::MotionChain::Config& c) {
  return {
      {"robot", "speed_mm_s", &c.limits.speed_mm_s, "Greatest speed of the torch", "mm/s", 1, 5000},
      {"robot", "acceleration_mm_s2", &c.limits.acceleration_mm_s2, "Greatest acceleration",
       "mm/s2", 1, 1e5},
      {"robot", "jerk_mm_s3", &c.limits.jerk_mm_s3, "Greatest jerk", "mm/s3", 1, 1e7},
      {"robot", "angular_speed_rad_s", &c.limits.angular_speed_rad_s, "Greatest angular speed",
       "rad/s", 0.01, 50},
      {"robot", "angular_acceleration_rad_s2", &c.limits.angular_acceleration_rad_s2,
       "Greatest angular acceleration", "rad/s2", 0.01, 500},
      {"robot", "period_us", &c.period_us, "Between two set points", "us", 1000, 100000},
      {"weld", "wire_feed_m_min", &c.table.rows[0].wire_feed_m_min, "Wire feed", "m/min", 0, 40},
      {"weld", "voltage_v", &c.table.rows[0].voltage_v, "Voltage", "V", 0, 60},
  };
}

}  // namespace

std::vector<Key> motion_keys(pipeline::MotionChain::Config& config) {
  std::vector<Key> keys = torch_keys(config.torch);
  append(keys, path_keys(config.path));
  append(keys, limit_keys(config));
  return keys;
}

}  // namespace dseam::program
