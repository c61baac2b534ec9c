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

/// No list is longer than what its numbers are for.
void check_lists(const std::vector<Key>& keys, Contradictions& found) {
  for (const Key& key : keys) {
    const auto* list = std::get_if<Series>(&key.field);
    if (list == nullptr || list->told() <= std::max<std::size_t>(1, *list->in_use)) {
      continue;
    }
    const auto count = std::find_if(keys.begin(), keys.end(), [list](const Key& other) {
      const auto* const* number = std::get_if<std::uint8_t*>(&other.field);
      return number != nullptr && *number == list->in_use;
    });
    found.add(key.path() + " is " + value_text(key) + ", a list longer than " + count->path() +
              ", " + value_text(*count));
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
  const auto& passes = settings.motion.path.passes;
  double least_mm_s = passes[0].speed_mm_s;
  for (std::size_t i = 1; i < settings.motion.path.num_passes; ++i) {
    least_mm_s = std::min(least_mm_s, passes[i].speed_mm_s);
  }
  return dwell_s + 2.0 * way_mm / least_mm_s + ramp_s;
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
  for (std::size_t i = 0; i < path.num_passes; ++i) {
    const torch::Weave& weave = path.passes[i].weave;
    if (!is_valid(weave)) {
      found.add("path.weave asks for a motion that path.weave_pitch_mm = " +
                std::to_string(weave.pitch_mm) +
                " leaves no room for: at least 0.1 mm, and path.weave_dwell_left_mm with "
                "path.weave_dwell_right_mm at most 0.8 of it");
      return;
    }
  }
}

/// What is counted from 0 names one that there is.
void check_counted(const pipeline::MotionChain::Config& motion, Contradictions& found) {
  const torch::PathPlanner::Config& path = motion.path;
  const auto check = [&found](const char* key, std::uint8_t index, const char* count_key,
                              std::uint8_t count) {
    if (index >= count) {
      found.add(std::string(key) + " names number " + std::to_string(index) +
                ", counted from 0, but " + count_key + " is " + std::to_string(count));
    }
  };
  for (std::size_t i = 0; i < path.num_passes; ++i) {
    check("path.pass_schedule", path.passes[i].schedule, "weld.schedules", motion.table.num_rows);
    check("path.pass_crater_schedule", path.passes[i].crater_schedule, "weld.schedules",
          motion.table.num_rows);
  }
  for (std::size_t i = 0; i < path.num_sectors; ++i) {
    check("path.sector_pass", path.sectors[i].pass, "path.passes", path.num_passes);
    check("path.sector_schedule", path.sectors[i].schedule, "weld.schedules",
          motion.table.num_rows);
  }
  if (path.num_sectors == 0 && (path.sectors[0].from_mm > 0.0 || path.sectors[0].to_mm > 0.0)) {
    found.add("path.sector_from_mm and path.sector_to_mm name a stretch, but path.sectors is 0");
  }
  if (path.resume.active) {
    check("resume.pass", path.resume.pass, "path.passes", path.num_passes);
  }
}

}  // namespace

void check_together(const Settings& settings, const std::vector<Key>& keys) {
  Contradictions found(keys);
  check_pairs(keys, found);
  const pipeline::WeldPipeline::Config& map = settings.pipeline;
  found.check("map.fine_cell_mm", map.fine_cell_mm, "map.coarse_cell_mm", map.coarse_cell_mm, "mm");
  check_path(settings.motion.path, found);
  check_lists(keys, found);
  check_counted(settings.motion, found);
  check_motion(settings.motion, settings.session.session.motion, found);
  check_standing(settings, found);
  found.throw_if_any();
}

}  // namespace dseam::program
