// SPDX-License-Identifier: Apache-2.0
#include "config/key_tables.hpp"

namespace dseam::program {
namespace {

using namespace hal::sim;  // NOLINT(google-build-using-namespace): the table is about nothing else.

constexpr double kHalfTurn = 3.14159265358979323846;

std::vector<Key> joint_keys(JointConfig& c) {
  return {
      {"cell", "joint", choice(c.kind, {"set_in", "set_on", "shell_only", "t_fillet", "butt"}),
       "How nozzle and shell meet, or which open joint stands there"},
      {"cell", "shell", choice(c.shell, {"cylinder", "plane", "sphere"}), "Form of the shell"},
      {"cell", "shell_radius_mm", &c.shell_radius_mm, "Outer radius of the shell", "mm", 10, 1e5},
      {"cell", "shell_ovality_mm", &c.shell_ovality_mm, "Half the difference of its two radii",
       "mm", -20, 20},
      {"cell", "shell_wall_mm", &c.shell_wall_mm, "Wall of the shell", "mm", 0.5, 100},
      {"cell", "shell_length_mm", &c.shell_length_mm, "Length of the shell", "mm", 20, 2000},
      {"cell", "nozzle_radius_mm", &c.nozzle_radius_mm, "Outer radius of the nozzle", "mm", 5, 500},
      {"cell", "nozzle_ovality_mm", &c.nozzle_ovality_mm, "Half the difference of its two radii",
       "mm", -20, 20},
      {"cell", "nozzle_taper_rad", &c.nozzle_taper_rad, "Half-angle of a cone", "rad", -0.5, 0.5},
      {"cell", "nozzle_wall_mm", &c.nozzle_wall_mm, "Wall of the nozzle", "mm", 0.5, 100},
      {"cell", "nozzle_height_mm", &c.nozzle_height_mm, "Its rim above the shell", "mm", 5, 500},
      {"cell", "axis_angle_rad", &c.axis_angle_rad, "Nozzle's axis against the shell's", "rad", 0.5,
       kHalfTurn - 0.5},
      {"cell", "eccentricity_mm", &c.eccentricity_mm, "Distance of the two axes", "mm", -100, 100},
      {"cell", "gap_mm", &c.gap_mm, "Between the hole and the nozzle", "mm", 0, 20},
  };
}

std::vector<Key> clutter_keys(ClutterConfig& c, MarkerConfig& m) {
  return {
      {"cell", "table", &c.table, "A table under the shell"},
      {"cell", "clamps", &c.num_clamps, "Clamps on the shell", "", 0, 16},
      {"cell", "second_nozzle_radius_mm", &c.second_nozzle_radius_mm,
       "Radius of another nozzle; 0: none", "mm", 0, 200},
      {"cell", "bolt_holes", &c.num_bolt_holes, "Holes in the shell", "", 0, 16},
      {"cell", "tack_welds", &c.num_tack_welds, "Tacks on the joint", "", 0, 16},
      {"cell", "spatter", &c.num_spatter, "Beads of spatter", "", 0, 1000},
      {"cell", "markers", &m.count, "Marker discs round the joint", "", 0, 64},
      {"cell", "marker_diameter_mm", &m.diameter_mm, "Their diameter", "mm", 1, 30},
  };
}

std::vector<Key> scanner_keys(ScannerConfig& c, ViewConfig& v) {
  return {
      {"cell", "width", &c.width, "Columns of a frame", "pixels", 64, 4096},
      {"cell", "height", &c.height, "Rows of a frame", "pixels", 64, 4096},
      {"cell", "noise_mm", &c.noise_mm, "Noise of the depth, one standard deviation", "mm", 0, 5},
      {"cell", "dropout_share", &c.dropout_share, "Pixels without depth", "", 0, 1},
      {"cell", "dead_band_mm", &c.dead_band_mm, "Width about the joint without depth", "mm", 0, 50},
      {"cell", "unseen_share", &c.unseen_share, "Share of the seam that no view sees", "", 0, 1},
      {"cell", "views", &v.count, "Poses of the robot", "", 1, 16},
      {"cell", "pose_error_mm", &v.pose_error_mm, "Error of its reported position", "mm", 0, 50},
      {"cell", "pose_error_rad", &v.pose_error_rad, "Error of its reported orientation", "rad", 0,
       0.5},
  };
}

}  // namespace

std::vector<Key> cell_keys(CellConfig& c) {
  std::vector<Key> keys = joint_keys(c.joint);
  append(keys, clutter_keys(c.clutter, c.markers));
  append(keys, scanner_keys(c.scanner, c.views));
  keys.push_back({"cell", "seed", &c.seed, "Of all that is drawn by chance", "", 0, 1e9});
  return keys;
}

}  // namespace dseam::program
