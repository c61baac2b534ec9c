// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
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
  explicit Contradictions(const std::vector<Key>& keys) : keys_(keys) {}

  /// `what` is asked for by `key` and allowed by `gate` up to `most`.
  void check(const char* key, double what, const char* gate, double most, const char* unit) {
    if (what > most) {
      char line[256];
      std::snprintf(line, sizeof(line), "%s asks for %.6g %s, but %s allows %.6g %s", key, what,
                    unit, gate, most, unit);
      add(line);
    }
  }
  void add(const std::string& line) {
    text_ += (text_.empty() ? "" : "\n") + place_of(line) + line;
  }
  void throw_if_any() const {
    if (!text_.empty()) {
      throw Failure(ExitCode::kUsage, text_);
    }
  }

 private:
  /// Where the first of the keys that `line` names was set.
  [[nodiscard]] std::string place_of(const std::string& line) const {
    const auto set = std::find_if(keys_.begin(), keys_.end(), [&](const Key& key) {
      return !key.set_at.empty() && line.find(key.path()) != std::string::npos;
    });
    return set == keys_.end() ? "" : set->set_at + ": ";
  }

  const std::vector<Key>& keys_;
  std::string text_;
};

/// Every key "min_..." stays under the key "max_..." of its section.
void check_pairs(const std::vector<Key>& keys, Contradictions& found) {
  for (const Key& low : keys) {
    const std::size_t at = low.name.find("min_");
    if (at == std::string::npos) {
      continue;
    }
    std::string twin = low.name;
    twin.replace(at, 3, "max");
    for (const Key& high : keys) {
      const bool pair = high.section == low.section && high.name == twin;
      if (pair && !(*number(low) < *number(high))) {
        found.add(low.path() + " is " + value_text(low) + ", which is not less than " +
                  high.path() + ", " + value_text(high));
      }
    }
  }
}

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

void check_path(const torch::PathPlanner::Config& path, Contradictions& found) {
  found.check("path.lead_in_mm", path.lead_in_mm, "path.approach_mm", path.approach_mm, "mm");
  const torch::Weave& weave = path.passes[0].weave;
  if (!is_valid(weave)) {
    found.add("path.weave asks for a motion that path.weave_pitch_mm = " +
              std::to_string(weave.pitch_mm) + " leaves no room for: at least 0.1 mm");
  }
}

}  // namespace

void check_together(const Settings& settings, const std::vector<Key>& keys) {
  Contradictions found(keys);
  check_pairs(keys, found);
  const pipeline::WeldPipeline::Config& map = settings.pipeline;
  found.check("map.fine_cell_mm", map.fine_cell_mm, "map.coarse_cell_mm", map.coarse_cell_mm, "mm");
  check_path(settings.motion.path, found);
  check_motion(settings.motion, settings.session.session.motion, found);
  check_standing(settings, found);
  found.throw_if_any();
}

}  // namespace dseam::program
