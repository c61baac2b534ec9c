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

/// What each pass has of its own.
std::vector<Key> pass_keys(torch::PathPlanner::Config& c) {
  using torch::Pass;
  const auto each = [&c](auto place) { return series(c.passes, c.num_passes, place); };
  return {
      {"path", "passes", &c.num_passes, "Runs round the joint", "", 1,
       torch::PathPlanner::kMaxPasses},
      {"path", "speed_mm_s", each(&Pass::speed_mm_s), "Welding speed", "mm/s", 0.5, 100},
      {"path", "pass_across_mm", each(&Pass::across_mm),
       "Of a pass from the root, towards the nozzle", "mm", -50, 50},
      {"path", "pass_out_mm", each(&Pass::out_mm), "and away from the root", "mm", -50, 50},
      {"path", "pass_work_offset_rad", each(&Pass::work_offset_rad),
       "Of the torch of a pass, towards the nozzle", "rad", -1, 1},
      {"path", "pass_start_shift_mm", each(&Pass::start_shift_mm),
       "Start of a pass, past that of the seam", "mm", -1e4, 1e4},
      {"path", "pass_schedule", each(&Pass::schedule), "Row of [weld] for a pass, counted from 0",
       "", 0, trajectory::WeldTable::kMaxRows - 1},
      {"path", "pass_crater_schedule", each(&Pass::crater_schedule), "and the one for its crater",
       "", 0, trajectory::WeldTable::kMaxRows - 1},
  };
}

/// One shape for all passes: with no amplitude, a pass goes straight.
Choice weave_shape(torch::PathPlanner::Config& c) {
  return {{"none", "sine", "zig_zag", "triangle", "circle"},
          [&c] { return static_cast<std::size_t>(c.passes[0].weave.shape); },
          [&c](std::size_t i) {
            for (torch::Pass& pass : c.passes) {
              pass.weave.shape = static_cast<torch::WeaveShape>(i);
            }
          }};
}

std::vector<Key> weave_keys(torch::PathPlanner::Config& c) {
  const auto each = [&c](double torch::Weave::*member) {
    return series(c.passes, c.num_passes,
                  [member](torch::Pass& pass) -> double& { return pass.weave.*member; });
  };
  return {
      {"path", "weave", weave_shape(c), "Motion across the seam"},
      {"path", "weave_amplitude_mm", each(&torch::Weave::amplitude_mm), "To each side", "mm", 0,
       20},
      {"path", "weave_pitch_mm", each(&torch::Weave::pitch_mm),
       "Travel of one period, dwells included", "mm", 0, 50},
      {"path", "weave_dwell_left_mm", each(&torch::Weave::dwell_left_mm), "Travel on the left side",
       "mm", 0, 50},
      {"path", "weave_dwell_right_mm", each(&torch::Weave::dwell_right_mm),
       "Travel on the right side", "mm", 0, 50},
      {"path", "weave_height_mm", each(&torch::Weave::height_mm),
       "How far out a triangle crosses the middle", "mm", -20, 20},
  };
}

/// Arcs of the loop with welding parameters of their own: flat, uphill, overhead.
std::vector<Key> sector_keys(torch::PathPlanner::Config& c) {
  using torch::Sector;
  const auto each = [&c](auto place) { return series(c.sectors, c.num_sectors, place); };
  return {
      {"path", "sectors", &c.num_sectors, "Stretches with a row of [weld] of their own", "", 0,
       torch::PathPlanner::kMaxSectors},
      {"path", "sector_from_mm", each(&Sector::from_mm), "Along the seam, from its first point",
       "mm", 0, 1e5},
      {"path", "sector_to_mm", each(&Sector::to_mm), "Where less, it leads over the first point",
       "mm", 0, 1e5},
      {"path", "sector_pass", each(&Sector::pass), "The pass that is meant, counted from 0", "", 0,
       torch::PathPlanner::kMaxPasses - 1},
      {"path", "sector_schedule", each(&Sector::schedule), "Its row of [weld], counted from 0", "",
       0, trajectory::WeldTable::kMaxRows - 1},
  };
}

std::vector<Key> path_keys(torch::PathPlanner::Config& c) {
  return {
      {"path", "overlap_mm", &c.overlap_mm, "Past the start, on closed seams", "mm", 0, 500},
      {"path", "overlap_rad", &c.overlap_rad,
       "The same as a share of the turn; 0: overlap_mm holds", "rad", 0, 6.2},
      {"path", "approach_mm", &c.approach_mm, "Height of approach and retract", "mm", 1, 500},
      {"path", "lead_in_mm", &c.lead_in_mm, "Slow last part of the approach", "mm", 0, 200},
      {"path", "travel_mm_s", &c.travel_mm_s, "Speed without arc", "mm/s", 1, 1000},
      {"path", "preflow_s", &c.preflow_s, "Gas before the arc", "s", 0, 10},
      {"path", "ignition_s", &c.ignition_s, "Standing at the start with the arc on", "s", 0, 10},
      {"path", "crater_s", &c.crater_s, "Standing at the end with the arc on", "s", 0, 10},
      {"path", "postflow_s", &c.postflow_s, "Gas after the arc", "s", 0, 30},
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
  };
}

std::vector<Key> weld_keys(trajectory::WeldTable& table) {
  using trajectory::WeldSchedule;
  const auto each = [&table](auto place) { return series(table.rows, table.num_rows, place); };
  return {
      {"weld", "schedules", &table.num_rows, "Rows of welding parameters", "", 1,
       trajectory::WeldTable::kMaxRows},
      {"weld", "wire_feed_m_min", each(&WeldSchedule::wire_feed_m_min), "Wire feed", "m/min", 0,
       40},
      {"weld", "voltage_v", each(&WeldSchedule::voltage_v), "Voltage", "V", 0, 60},
  };
}

std::vector<Key> resume_keys(torch::Resume& c) {
  return {
      {"resume", "active", &c.active, "Take up a bead that was broken off"},
      {"resume", "pass", &c.pass, "Passes before this one are done, counted from 0", "", 0,
       torch::PathPlanner::kMaxPasses - 1},
      {"resume", "stopped_mm", &c.stopped_mm, "Where the arc went off, from the pass' start", "mm",
       0, 1e5},
      {"resume", "run_up_mm", &c.run_up_mm, "Travel without arc before it strikes again", "mm", 0,
       1000},
      {"resume", "overlap_mm", &c.overlap_mm, "which it does so far before the stop", "mm", 0,
       1000},
  };
}

}  // namespace

std::vector<Key> motion_keys(pipeline::MotionChain::Config& config) {
  std::vector<Key> keys = torch_keys(config.torch);
  append(keys, pass_keys(config.path));
  append(keys, path_keys(config.path));
  append(keys, weave_keys(config.path));
  append(keys, sector_keys(config.path));
  append(keys, resume_keys(config.path.resume));
  append(keys, limit_keys(config));
  append(keys, weld_keys(config.table));
  return keys;
}

}  // namespace dseam::program
