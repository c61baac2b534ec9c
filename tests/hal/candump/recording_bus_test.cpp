// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/candump/recording_bus.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "dseam/hal/candump/candump_format.hpp"
#include "hal/sim_robot/cell.hpp"
#include "support/allocation_counter.hpp"

namespace dseam::test {
namespace {

/// A file that is gone with the test.
class Log {
 public:
  explicit Log(const char* name) : path_(::testing::TempDir() + name) {
    file_ = std::fopen(path_.c_str(), "w");
  }
  ~Log() {
    std::fclose(file_);
    std::remove(path_.c_str());
  }
  std::FILE* file() { return file_; }
  std::vector<std::string> lines() const {
    std::ifstream in(path_);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) {
      lines.push_back(line);
    }
    return lines;
  }

 private:
  std::string path_;
  std::FILE* file_;
};

TEST(RecordingBus, every_frame_of_a_weld_is_in_the_log_in_the_order_of_time) {
  hal::fake::ManualClock clock(1'000'000'000);
  hal::sim::SimBus bus({}, clock);
  hal::candump::RecordingBus recorded(bus.connect(), clock, "sim0");
  hal::sim::SimRobot robot({}, bus.connect());
  hal::LinkPort port(recorded);
  link::Sender sender = link::Sender::make({}).value();
  const auto points = round_weld(500, 4000);
  const AllocationCounter counter;

  auto progress = link::WeldProgress::kUnderWay;
  while (progress == link::WeldProgress::kUnderWay) {
    clock.advance(LinkCell::kStepNs);
    progress = link::give_next_order(sender, {5, 1, points, true}, clock.now_ns());
    port.turn(sender, clock.now_ns());
    robot.step(clock.now_ns());
  }
  EXPECT_EQ(counter.count(), 0U);
  Log log("weld.log");
  ASSERT_TRUE(recorded.flush(log.file()).ok());

  ASSERT_EQ(progress, link::WeldProgress::kDone);
  const auto lines = log.lines();
  EXPECT_EQ(lines.size(), port.report().sent + port.report().received);
  EXPECT_EQ(recorded.not_recorded(), 0U);
  std::int64_t before_ns = 0;
  for (const std::string& line : lines) {
    const auto frame = hal::candump::from_line(line);
    ASSERT_TRUE(frame.ok()) << line;
    EXPECT_GE(frame.value().stamp_ns, before_ns);
    before_ns = frame.value().stamp_ns;
  }
}

TEST(RecordingBus, a_full_ring_counts_what_it_could_not_keep) {
  hal::fake::ManualClock clock;
  hal::sim::SimBus bus({}, clock);
  hal::candump::RecordingBus recorded(bus.connect(), clock, "sim0", 4);
  bus.connect();

  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(recorded.send({}).ok());
  }
  Log log("full.log");
  ASSERT_TRUE(recorded.flush(log.file()).ok());

  EXPECT_EQ(recorded.not_recorded(), 2U);
  EXPECT_EQ(log.lines().size(), 4U);
}

}  // namespace
}  // namespace dseam::test
