// SPDX-License-Identifier: Apache-2.0
// A million points over a bus that loses, doubles, delays and spoils frames, in virtual time.
#include <gtest/gtest.h>

#include <string>

#include "dseam/link/codec.hpp"
#include "hal/sim_robot/cell.hpp"

namespace dseam::test {
namespace {

/// Points whose every field follows from their place and session, so that any mix-up shows.
std::vector<trajectory::SetPoint> marked_points(std::size_t count, std::uint32_t session) {
  std::vector<trajectory::SetPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i].t_us = static_cast<std::uint32_t>(i) * 2000;
    points[i].pose.p_base = {static_cast<double>(session), static_cast<double>(i) * 0.001, 1.0};
    points[i].speed_mm_s = 0.5;
    points[i].s_mm = static_cast<double>(i) * 0.001;
    points[i].arc = true;
  }
  return points;
}

struct Tally {
  std::uint64_t executed = 0;
  std::uint64_t wrong = 0;    ///< Lost, doubled, out of order, or not what was sent.
  std::uint64_t foreign = 0;  ///< Of another session than the one that runs.
  std::uint64_t done = 0;
  std::uint64_t tripped = 0;
};

/// One weld from HELLO to its end, whatever that is; what the robot executed is compared.
void weld_once(LinkCell& cell, std::uint32_t session, std::size_t count, Tally& tally) {
  const auto points = marked_points(count, session);
  const std::size_t before = cell.robot_.executed().size();
  (void)cell.sender_.connect(session, cell.clock_.now_ns());
  const auto end = cell.run({session, 1, points, true}, 2 * static_cast<int>(count) + 5000);
  (void)cell.sender_.stop(cell.clock_.now_ns());
  for (int i = 0; i < 300; ++i) {  // A stop takes 200 ms.
    cell.step_without_orders();
  }
  tally.done += end == link::WeldProgress::kDone ? 1U : 0U;
  tally.tripped += end == link::WeldProgress::kFailed ? 1U : 0U;
  const auto executed = cell.robot_.executed().subspan(before);
  for (std::size_t i = 0; i < executed.size(); ++i) {
    const link::DuePoint& due = executed[i].due;
    const bool right = due.index == i && i < count && due.point.t_us == points[i].t_us &&
                       (due.point.pose.p_base - points[i].pose.p_base).norm() < 1e-6;
    tally.wrong += right ? 0U : 1U;
    tally.foreign += due.session == session ? 0U : 1U;
  }
  tally.wrong += end == link::WeldProgress::kDone && executed.size() != count ? 1U : 0U;
  tally.executed += executed.size();
}

hal::sim::SimBus::Config seeded(std::uint64_t seed) {
  hal::sim::SimBus::Config config;
  config.seed = seed;
  return config;
}

hal::sim::SimRobot::Config recording(std::size_t points) {
  hal::sim::SimRobot::Config config;
  config.record_points = points;
  return config;
}

/// True: a classic bus, the messages in segments.
class LinkCampaign : public ::testing::TestWithParam<bool> {
 protected:
  static link::Sender::Config sender() {
    link::Sender::Config config;
    config.addressing.classic = GetParam();
    return config;
  }
  static hal::sim::SimRobot::Config robot(std::size_t points) {
    hal::sim::SimRobot::Config config = recording(points);
    config.receiver.addressing.classic = GetParam();
    return config;
  }
};
INSTANTIATE_TEST_SUITE_P(Buses, LinkCampaign, ::testing::Bool(),
                         [](const auto& bus) { return bus.param ? "Classic" : "Fd"; });

TEST_P(LinkCampaign, a_million_points_arrive_once_in_order_and_unspoilt) {
  constexpr std::size_t kPoints = 1'000'000;
  LinkCell cell(seeded(1), sender(), robot(kPoints + 200'000));
  hal::sim::BusFaults faults;
  faults.lost = 5e-4;
  faults.duplicated = 5e-4;
  faults.delayed = 5e-4;
  faults.flipped = 5e-4;
  faults.garbage = 2e-4;
  faults.truncated = 2e-4;
  faults.stuck = 2e-4;
  faults.wrong = 2e-4;
  cell.bus_.set_faults(faults);
  Tally tally;

  for (std::uint32_t session = 1; tally.executed < kPoints && session < 2000; ++session) {
    weld_once(cell, session, 5'000, tally);
  }

  EXPECT_GE(tally.executed, kPoints);
  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_EQ(tally.foreign, 0U);
  EXPECT_GT(tally.done * 5'000, kPoints / 4);  // From welds that went to their end.
  EXPECT_GE(cell.bus_.fault_counts().total(), 4000U);
  RecordProperty("faults", std::to_string(cell.bus_.fault_counts().total()));
  RecordProperty("welds_done", std::to_string(tally.done));
  RecordProperty("welds_tripped", std::to_string(tally.tripped));
}

class HardFaults : public ::testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, HardFaults, ::testing::Range<std::uint64_t>(1, 9));

/// So bad a bus that welds end early: each must end in a named state, and never do wrong.
TEST_P(HardFaults, ten_thousand_faults_end_in_named_states_and_no_wrong_point) {
  LinkCell cell(seeded(GetParam()), {}, recording(200'000));
  hal::sim::BusFaults faults;
  faults.lost = 0.01;
  faults.duplicated = 0.01;
  faults.delayed = 0.01;
  faults.flipped = 0.01;
  faults.garbage = 0.005;
  faults.truncated = 0.005;
  faults.stuck = 0.005;
  faults.wrong = 0.005;
  cell.bus_.set_faults(faults);
  Tally tally;

  for (std::uint32_t session = 1; cell.bus_.fault_counts().total() < 10'000; ++session) {
    weld_once(cell, session, 2000, tally);
    const bool named = cell.sender_.state() == link::HostState::kIdle ||
                       cell.sender_.fault() != link::Fault::kNone;
    ASSERT_TRUE(named) << session;
    ASSERT_FALSE(cell.robot_.receiver().arc_on()) << session;
  }

  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_EQ(tally.foreign, 0U);
}

}  // namespace
}  // namespace dseam::test
