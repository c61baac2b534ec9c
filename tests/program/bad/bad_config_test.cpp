// SPDX-License-Identifier: Apache-2.0
// Every way in which a value of the configuration can be wrong, made from the table of keys itself:
// a key that is added to it is covered by that alone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>

#include "command/invocation.hpp"
#include "config/load.hpp"
#include "dseam/hal/fake/fake_can_bus.hpp"
#include "dseam/hal/fake/manual_clock.hpp"
#include "program/support/run_program.hpp"
#include "support/arena_owner.hpp"

namespace dseam::program {
namespace {

struct BadValue {
  const char* kind;
  std::string value;  ///< As it stands in the file.
};

std::string digits(double value) {
  std::ostringstream text;
  text.precision(17);
  text << std::showpoint << value;
  return text.str();
}

bool is_whole(const Key& key) {
  const auto* series = std::get_if<Series>(&key.field);
  return (series != nullptr && series->whole) || std::holds_alternative<std::uint8_t*>(key.field) ||
         std::holds_alternative<std::uint16_t*>(key.field) ||
         std::holds_alternative<std::uint32_t*>(key.field) ||
         std::holds_alternative<std::uint64_t*>(key.field);
}

bool is_series(const Key& key) { return std::holds_alternative<Series>(key.field); }

bool is_numeric(const Key& key) { return number(key) || is_series(key); }

void add_numbers(const Key& key, std::vector<BadValue>& bad) {
  const auto text = [&](double value) {
    return is_whole(key) ? std::to_string(static_cast<std::int64_t>(value)) : digits(value);
  };
  const double step = is_whole(key) ? 1.0 : 1e-3 + 1e-3 * std::abs(key.min);
  bad.push_back({"under its least", text(key.min - step)});
  bad.push_back({"over its greatest",
                 text(key.max + (is_whole(key) ? 1.0 : 1e-3 + 1e-3 * std::abs(key.max)))});
  bad.push_back({"infinite", "inf"});
  bad.push_back({"less than anything", "-inf"});
  bad.push_back({"of another type", "true"});
  if (is_whole(key)) {
    bad.push_back({"with a fraction", digits(key.min + 0.5)});
  }
}

/// What is wrong for one number is wrong for any of a list.
void add_lists(const Key& key, std::vector<BadValue>& bad) {
  const std::size_t numbers = bad.size();
  const std::string good = is_whole(key) ? "1" : "1.0";
  for (std::size_t i = 0; i < numbers; ++i) {
    bad.push_back({"one of a list", "[" + good + ", " + bad[i].value + "]"});
  }
  std::string longer = good;
  for (std::size_t i = 0; i < std::get<Series>(key.field).size; ++i) {
    longer += ", " + good;
  }
  bad.push_back({"a list that is too long", "[" + longer + "]"});
  bad.push_back({"an empty list", "[]"});
  bad.push_back({"a list of lists", "[[1]]"});
}

std::vector<BadValue> bad_values(const Key& key) {
  std::vector<BadValue> bad = {{"no number", "nan"}, {"a section", "{ x = 1 }"}};
  if (!is_series(key)) {
    bad.push_back({"a list", "[1]"});
  }
  if (is_numeric(key)) {
    bad.push_back({"a word", "\"often\""});
    add_numbers(key, bad);
    if (is_series(key)) {
      add_lists(key, bad);
    }
  } else if (std::holds_alternative<std::string*>(key.field)) {
    bad.push_back({"of another type", "7"});
  } else {
    bad.push_back({"a number", "1"});
    bad.push_back({"another word", "\"often\""});
  }
  return bad;
}

/// A file with that one line, as every command reads it.
std::string refusal_of(const test::ScratchFolder& scratch, const std::string& content,
                       ExitCode& code) {
  Invocation invocation;
  invocation.config_file = scratch.write("dseam.toml", content);
  Settings settings;
  try {
    invocation.configure(settings);
  } catch (const Failure& failure) {
    code = failure.code();
    return failure.what();
  }
  code = ExitCode::kDone;
  return "";
}

TEST(BadConfig, each_value_that_no_key_can_have_is_refused_with_its_key_line_and_range) {
  const test::ScratchFolder scratch;
  const std::string place = scratch.path("dseam.toml") + ":2: ";
  Settings settings;
  std::size_t cases = 0;
  for (const Key& key : keys_of(settings)) {
    for (const BadValue& bad : bad_values(key)) {
      ExitCode code{};

      const std::string said = refusal_of(
          scratch, "[" + key.section + "]\n" + key.name + " = " + bad.value + "\n", code);

      EXPECT_EQ(code, ExitCode::kUsage) << key.path() << ", " << bad.kind << ": " << bad.value;
      EXPECT_EQ(said.find(place + "'" + key.path() + "' cannot be "), 0U) << said;
      EXPECT_NE(said.find("; allowed: " + range_text(key)), std::string::npos) << said;
      ++cases;
    }
  }

  RecordProperty("cases", std::to_string(cases));
  EXPECT_GE(cases, 500U);
}

TEST(BadConfig, each_number_of_the_table_has_a_least_and_a_greatest_value) {
  Settings settings;
  for (const Key& key : keys_of(settings)) {
    if (is_numeric(key)) {
      EXPECT_TRUE(std::isfinite(key.min) && std::isfinite(key.max) && key.min < key.max)
          << key.path();
    }
  }
}

TEST(BadConfig, a_least_value_that_is_not_under_its_greatest_is_refused_with_both_and_the_line) {
  const test::ScratchFolder scratch;
  Settings settings;
  const std::vector<Key> keys = keys_of(settings);
  std::size_t pairs = 0;
  for (const Key& low : keys) {
    const std::size_t at = low.name.find("min_");
    std::string twin = low.name;
    twin.replace(at == std::string::npos ? 0 : at, at == std::string::npos ? 0 : 3, "max");
    const auto high = std::find_if(keys.begin(), keys.end(), [&](const Key& key) {
      return &key != &low && key.section == low.section && key.name == twin;
    });
    if (high == keys.end()) {
      continue;
    }
    for (const double more : {0.0, 1.0}) {  // As much is too much, too.
      ExitCode code{};
      const std::string said = refusal_of(
          scratch,
          "[" + low.section + "]\n" + low.name + " = " + digits(*number(*high) - 2.0 + more) +
              "\n" + high->name + " = " + digits(*number(*high) - 2.0) + "\n",
          code);

      EXPECT_EQ(code, ExitCode::kUsage) << low.path();
      EXPECT_EQ(said.find(scratch.path("dseam.toml") + ":"), 0U) << said;
      EXPECT_NE(said.find(low.path()), std::string::npos) << said;
      EXPECT_NE(said.find(high->path()), std::string::npos) << said;
      ++pairs;
    }
  }

  EXPECT_EQ(pairs, 2U * (6U + 3U + 3U + 1U));  // paper, seam, rt, and the radii of markers.
}

TEST(BadConfig, values_that_do_not_go_together_are_refused_with_the_line_that_set_one) {
  const test::ScratchFolder scratch;
  const struct {
    const char* content;
    const char* line;
    std::array<const char*, 2> keys;
  } cases[] = {
      {"[path]\nlead_in_mm = 60\n", ":2: ", {"path.lead_in_mm", "path.approach_mm"}},
      {"[path]\n\napproach_mm = 2\n", ":3: ", {"path.lead_in_mm", "path.approach_mm"}},
      {"[path]\nweave = \"sine\"\nweave_pitch_mm = 0\n",
       ":2: ",
       {"path.weave", "path.weave_pitch_mm"}},
      {"[path]\nweave=\"sine\"\nweave_amplitude_mm=1\nweave_pitch_mm=3\n"
       "weave_dwell_left_mm=2\nweave_dwell_right_mm=0.5\n",
       ":",
       {"path.weave_dwell_left_mm", "path.weave_dwell_right_mm"}},
      {"[path]\npasses=2\npass_out_mm=[0.0, 2.0, 4.0]\n",
       ":2: ",
       {"path.pass_out_mm", "path.passes"}},
      {"[weld]\nvoltage_v=[20.0, 18]\n", ":2: ", {"weld.voltage_v", "weld.schedules"}},
      {"[path]\npass_schedule=1\n", ":2: ", {"path.pass_schedule", "weld.schedules"}},
      {"[path]\npass_crater_schedule=1\n", ":2: ", {"path.pass_crater_schedule", "weld.schedules"}},
      {"[path]\nsectors=1\nsector_pass=1\n", ":3: ", {"path.sector_pass", "path.passes"}},
      {"[path]\nsectors=1\nsector_schedule=1\n",
       ":3: ",
       {"path.sector_schedule", "weld.schedules"}},
      {"[path]\nsector_to_mm=90\n", ":2: ", {"path.sector_to_mm", "path.sectors"}},
      {"[resume]\nactive=true\npass=1\n", ":3: ", {"resume.pass", "path.passes"}},
      {"[path]\npasses=2\nspeed_mm_s=[8.0, 0.5]\n", ":", {"path.crater_s", "rt.max_standing_s"}},
      {"[map]\nfine_cell_mm = 20\n", ":2: ", {"map.fine_cell_mm", "map.coarse_cell_mm"}},
      {"[rt]\nmax_standing_s = 0.2\n", ":2: ", {"path.crater_s", "rt.max_standing_s"}},
      {"[robot]\njerk_mm_s3 = 70000\n", ":2: ", {"robot.jerk_mm_s3", "rt.max_jerk_mm_s3"}},
  };
  for (const auto& c : cases) {
    ExitCode code{};

    const std::string said = refusal_of(scratch, c.content, code);

    EXPECT_EQ(code, ExitCode::kUsage) << c.content;
    EXPECT_EQ(said.find(scratch.path("dseam.toml") + c.line), 0U) << said;
    for (const char* key : c.keys) {
      EXPECT_NE(said.find(key), std::string::npos) << said;
    }
  }
}

/// What the table and its cross checks let through must not be refused when the scan is done.
void expect_stages_take(const Settings& settings, const std::string& what) {
  constexpr std::size_t kPoints = 1000;
  pipeline::WeldPipeline::Capacity scan;
  scan.views = {.width = 64, .height = 64, .max_views = 2};
  scan.seam.max_points = scan.max_voxels = scan.max_seam_points = kPoints;
  pipeline::MotionChain::Capacity motion;
  motion.max_seam_points = motion.max_torch_points = motion.max_path_points = kPoints;
  dseam::test::ArenaOwner memory(pipeline::WeldPipeline::bytes(scan) +
                                 pipeline::MotionChain::bytes(motion) +
                                 pipeline::PaperPipeline::bytes(kPoints));
  pipeline::WeldPipeline::Config pipeline = settings.pipeline;
  pipeline.seam = settings.seam;
  link::Sender sender = link::Sender::make(settings.session.link).value();
  hal::fake::ManualClock clock;
  hal::fake::FakeCanBus bus(clock);
  rt::WeldSession::Config session = settings.session.session;
  session.arc.workspace = session.motion.workspace = settings.session.workspace;

  EXPECT_TRUE(pipeline::WeldPipeline::make(pipeline, scan, memory.arena()).ok()) << what;
  EXPECT_TRUE(pipeline::MotionChain::make(settings.motion, motion, memory.arena()).ok()) << what;
  EXPECT_TRUE(pipeline::PaperPipeline::make(settings.paper, kPoints, memory.arena()).ok()) << what;
  EXPECT_TRUE(rt::WeldSession::make(session, sender, bus).ok()) << what;
}

TEST(BadConfig, what_is_let_through_at_the_start_is_not_refused_by_a_stage_later_on) {
  Settings all;
  for (const Key& key : keys_of(all)) {
    for (const double bound : {key.min, key.max}) {
      Settings settings;
      std::vector<Key> keys = keys_of(settings);
      if (!is_numeric(key)) {
        continue;
      }
      const std::string value =
          is_whole(key) ? std::to_string(static_cast<std::int64_t>(bound)) : digits(bound);
      set_key(key.path() + " = " + value, keys);
      try {
        check_together(settings, keys);
      } catch (const Failure&) {
        continue;
      }
      expect_stages_take(settings, key.path() + " = " + value);
    }
  }
}

TEST(BadConfig, a_file_of_nothing_else_is_refused_line_by_line_before_anything_is_opened) {
  const test::ScratchFolder scratch;
  Settings settings;
  std::string content;
  std::string section;
  std::size_t bad = 0;
  for (const Key& key : keys_of(settings)) {
    content += key.section == section ? "" : "[" + key.section + "]\n";
    section = key.section;
    content += key.name + " = nan\n";
    ++bad;
  }
  const std::string file = scratch.write("dseam.toml", content);

  const test::Outcome outcome = test::run_program({"weld", "--camera", "sim", "--robot", "sim",
                                                   "--config", file, "--out", scratch.path("out")});

  EXPECT_EQ(outcome.exit_code, 2);
  std::size_t lines = 0;
  std::istringstream said(outcome.text);
  for (std::string line; std::getline(said, line); ++lines) {
    EXPECT_EQ(line.find("dseam: " + file + ":"), 0U) << line;
  }
  EXPECT_EQ(lines, bad);
  EXPECT_TRUE(scratch.names_in("out").empty());
}

}  // namespace
}  // namespace dseam::program
