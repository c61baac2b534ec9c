// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string>

#include "config/settings.hpp"
#include "failure.hpp"

namespace dseam::program {
namespace {

/// Collects what does not go together, a line each.
class Contradictions {
 public:
  /// `what` is asked for by `key` and allowed by `gate` up to `most`.
  void check(const char* key, double what, const char* gate, double most, const char* unit) {
    if (what > most) {
      char line[256];
      std::snprintf(line, sizeof(line), "%s asks for %.6g %s, but %s allows %.6g %s", key, what,
                    unit, gate, most, unit);
      text_ += (text_.empty() ? "" : "\n") + std::string(line);
    }
  }
  void throw_if_any() const {
    if (!text_.empty()) {
      throw Failure(ExitCode::kUsage, text_);
    }
  }

 private:
  std::string text_;
};

void check_motion(const pipeline::MotionChain::Config& motion, const rt::MotionGate::Config& gate,
                  Contradictions& found) {
  const trajectory::Limits& robot = motion.limits;
  const double period_s = 1e-6 * motion.period_us;
  found.check("robot.speed_mm_s", robot.speed_mm_s, "rt.max_speed_mm_s", gate.max_speed_mm_s,
              "mm/s");
  found.check("robot.acceleration_mm_s2", robot.acceleration_mm_s2, "rt.max_acceleration_mm_s2",
              gate.max_acceleration_mm_s2, "mm/s2");
  found.check("robot.jerk_mm_s3", robot.jerk_mm_s3, "rt.max_jerk_mm_s3", gate.max_jerk_mm_s3,
              "mm/s3");
  found.check("robot.angular_speed_rad_s", robot.angular_speed_rad_s, "rt.max_turn_rad_s",
              gate.max_turn_rad_s, "rad/s");
  found.check("robot.speed_mm_s over robot.period_us", robot.speed_mm_s * period_s,
              "rt.max_step_mm", gate.max_step_mm, "mm");
  found.check("robot.angular_speed_rad_s over robot.period_us",
              robot.angular_speed_rad_s * period_s, "rt.max_step_rad", gate.max_step_rad, "rad");
}

/// How long the torch counts as standing when it stands for `dwell_s` and then moves off, or moves
/// up to where it stands: the speed is reached within that way, so half of it is the mean.
double standing_s(double dwell_s, const Settings& settings) {
  const double way_mm = settings.session.session.tracker.standing_mm;
  const double ramp_s = std::sqrt(2.0 * way_mm / settings.motion.limits.acceleration_mm_s2);
  return dwell_s + 2.0 * way_mm / settings.motion.path.passes[0].speed_mm_s + ramp_s;
}

void check_standing(const Settings& settings, Contradictions& found) {
  const torch::PathPlanner::Config& path = settings.motion.path;
  const double most_s = settings.session.max_standing_s;
  found.check("path.ignition_s, with the first half millimetre at path.speed_mm_s,",
              standing_s(path.ignition_s, settings), "rt.max_standing_s", most_s, "s");
  found.check("path.crater_s, with the last half millimetre at path.speed_mm_s,",
              standing_s(path.crater_s, settings), "rt.max_standing_s", most_s, "s");
}

void check_workspace(const rt::Workspace& box, Contradictions& found) {
  const std::string axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    found.check(("rt.workspace_min_" + axes[i] + "_mm").c_str(), box.low_mm[i],
                ("rt.workspace_max_" + axes[i] + "_mm").c_str(), box.high_mm[i], "mm");
  }
}

}  // namespace

void check_against_gates(const Settings& settings) {
  Contradictions found;
  check_motion(settings.motion, settings.session.session.motion, found);
  check_standing(settings, found);
  check_workspace(settings.session.workspace, found);
  found.throw_if_any();
}

}  // namespace dseam::program
