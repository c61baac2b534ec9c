// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "dseam/hal/candump/candump_format.hpp"
#include "dseam/link/channel.hpp"
#include "dseam/link/codec.hpp"
#include "program/support/running_program.hpp"

namespace dseam::program {
namespace {

using test::Outcome;
using test::RunningProgram;

/// What a log of the bus says of the last abort and of the arc.
struct BusRecord {
  std::int64_t abort_ns = 0;     ///< The first frame that aborts.
  std::int64_t arc_off_ns = 0;   ///< The first status without arc after it.
  bool arc_before = false;       ///< The last status before it.
  std::size_t points_after = 0;  ///< Set points sent after it.
};

link::Frame link_frame(const hal::CanFrame& frame) {
  return {frame.id, frame.fd, frame.size_bytes, frame.data};
}

BusRecord read_log(const std::string& file) {
  constexpr link::Addressing kAddressing;
  BusRecord record;
  std::ifstream log(file);
  for (std::string line; std::getline(log, line);) {
    const auto frame = hal::candump::from_line(line);
    if (!frame.ok()) {
      ADD_FAILURE() << line;
      continue;
    }
    const std::uint32_t id = frame.value().id;
    const bool aborted = record.abort_ns > 0;
    if (id == kAddressing.id_of(link::MessageId::kAbort) && !aborted) {
      record.abort_ns = frame.value().stamp_ns;
    }
    if (aborted && id == kAddressing.id_of(link::MessageId::kPoint)) {
      ++record.points_after;
    }
    if (id == kAddressing.id_of(link::MessageId::kStatus)) {
      const bool arc = link::decode_status(link_frame(frame.value())).value().arc_on;
      record.arc_before = aborted ? record.arc_before : arc;
      record.arc_off_ns =
          aborted && !arc && record.arc_off_ns == 0 ? frame.value().stamp_ns : record.arc_off_ns;
    }
  }
  return record;
}

bool has_temporary_file(const std::set<std::string>& names) {
  return std::any_of(names.begin(), names.end(),
                     [](const std::string& name) { return name.ends_with(".tmp"); });
}

TEST(Interrupt, while_it_scans_ends_within_a_second_and_leaves_nothing) {
  const test::ScratchFolder scratch;
  // Sixteen views, interrupted at the first: however fast the machine, it is not over by then.
  RunningProgram weld({"weld", "--camera", "sim", "--robot", "sim", "--set", "cell.width=972",
                       "--set", "cell.height=724", "--set", "cell.views=16", "--out",
                       scratch.path("out")});
  ASSERT_TRUE(weld.writes("scanning: 0 of 16"));

  weld.interrupt();
  const Outcome outcome = weld.wait();

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("interrupted"), std::string::npos) << outcome.text;
  EXPECT_LE(weld.seconds_to_end(), 1.0);
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out")));
}

TEST(Interrupt, while_it_welds_turns_the_arc_off_within_10_ms_and_keeps_the_record) {
  const test::ScratchFolder scratch;
  RunningProgram weld({"weld", "--camera", "sim", "--robot", "sim", "--set", "cell.width=648",
                       "--set", "cell.height=484", "--set", "path.speed_mm_s=0.5", "--set",
                       "rt.max_standing_s=3", "--out", scratch.path("out")});
  ASSERT_TRUE(weld.writes("welding: ", 2));  // The first may be of the approach.

  weld.interrupt();
  const Outcome outcome = weld.wait();

  EXPECT_EQ(outcome.exit_code, 5) << outcome.text;
  EXPECT_NE(outcome.text.find("interrupted: the robot confirmed that the arc is off"),
            std::string::npos)
      << outcome.text;
  EXPECT_LE(weld.seconds_to_end(), 1.0);
  const std::set<std::string> names = scratch.names_in("out");
  EXPECT_FALSE(has_temporary_file(names));
  EXPECT_EQ(names.count("can.log"), 1U);
  const BusRecord record = read_log(scratch.path("out/can.log"));
  EXPECT_TRUE(record.arc_before);
  ASSERT_GT(record.abort_ns, 0);
  ASSERT_GT(record.arc_off_ns, record.abort_ns);
  EXPECT_LE(record.arc_off_ns - record.abort_ns, 10'000'000);
  EXPECT_EQ(record.points_after, 0U);
  std::ifstream file(scratch.path("out/report.json"));
  const auto report = nlohmann::json::parse(file);
  EXPECT_NE(report["fault"].get<std::string>().find("interrupted"), std::string::npos);
  EXPECT_NE(report["robot"]["to take the bead up again"].get<std::string>().find("resume.pass=0"),
            std::string::npos);
}

}  // namespace
}  // namespace dseam::program
