// SPDX-License-Identifier: Apache-2.0
#include "config/key_tables.hpp"

namespace dseam::program {

namespace {

constexpr double kWideMm = 1.0e5;

std::vector<Key> arc_gate_keys(WeldRun::Config& config) {
  rt::ArcGate::Config& arc = config.session.arc;
  return {
      {"rt", "min_confidence", choice(arc.min_confidence, {"none", "low", "medium", "high"}),
       "The arc goes off where the seam is less certain"},
      {"rt", "max_tracking_mm", &arc.max_tracking_mm,
       "The arc goes off when the torch is farther from where it was sent", "mm", 0.1, 100},
      {"rt", "max_corridor_mm", &arc.max_corridor_mm,
       "The arc goes off when the torch is farther beside the path", "mm", 0.1, 100},
      {"rt", "max_standing_s", &config.max_standing_s,
       "The arc goes off when the torch stays in one place for longer", "s", 0.1, 30},
  };
}

/// What a set point may be; a path that has another one is not sent at all.
std::vector<Key> motion_gate_keys(rt::MotionGate::Config& gate) {
  return {
      {"rt", "max_speed_mm_s", &gate.max_speed_mm_s,
       "A path with a faster set point is not sent at all", "mm/s", 1, 5000},
      {"rt", "max_acceleration_mm_s2", &gate.max_acceleration_mm_s2,
       "Nor one with a greater acceleration", "mm/s2", 1, 1e6},
      {"rt", "max_jerk_mm_s3", &gate.max_jerk_mm_s3, "Nor one with a greater jerk", "mm/s3", 1,
       1e8},
      {"rt", "max_turn_rad_s", &gate.max_turn_rad_s, "Nor one that turns faster", "rad/s", 0.01,
       50},
      {"rt", "max_step_mm", &gate.max_step_mm, "Nor one with a longer way between set points", "mm",
       0.1, 1000},
      {"rt", "max_step_rad", &gate.max_step_rad, "Nor one with a wider turn between set points",
       "rad", 0.001, 1},
  };
}

std::vector<Key> workspace_keys(rt::Workspace& box) {
  std::vector<Key> keys;
  const std::string axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    keys.push_back({"rt", "workspace_min_" + axes[i] + "_mm", &box.low_mm[i],
                    "No set point lies beyond, and the arc goes off there", "mm", -kWideMm,
                    kWideMm});
    keys.push_back({"rt", "workspace_max_" + axes[i] + "_mm", &box.high_mm[i],
                    "No set point lies beyond, and the arc goes off there", "mm", -kWideMm,
                    kWideMm});
  }
  return keys;
}

}  // namespace

std::vector<Key> session_keys(WeldRun::Config& config) {
  link::Addressing& addressing = config.link.addressing;
  std::vector<Key> keys = {{"rt", "allow_degraded", &config.session.allow_degraded,
                            "Arm although the system is not real-time"}};
  append(keys, arc_gate_keys(config));
  append(keys, motion_gate_keys(config.session.motion));
  append(keys, workspace_keys(config.workspace));
  append(keys, {{"link", "base_id", &addressing.base_id, "Identifier of the link's first message",
                 "", 0, 2047 - link::kMessageCount},
                {"link", "classic", &addressing.classic, "Segments of 8 bytes instead of CAN FD"}});
  return keys;
}

}  // namespace dseam::program
