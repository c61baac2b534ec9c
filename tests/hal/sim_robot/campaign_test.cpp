// SPDX-License-Identifier: Apache-2.0
// A million points over a bus that loses, doubles, delays and spoils frames, in virtual time.
#include <gtest/gtest.h>

#include <iostream>
#include <string>

#include "hal/sim_robot/weld_tally.hpp"

namespace dseam::test {
namespace {

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
  cell.bus_.set_faults(faults_of_every_kind(5e-4, 2e-4));
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
  cell.bus_.set_faults(faults_of_every_kind(0.01, 0.005));
  Tally tally;

  for (std::uint32_t session = 1; cell.bus_.fault_counts().total() < 10'000; ++session) {
    weld_once(cell, session, 2000, tally);
    const bool named = cell.sender_.state() == link::HostState::kIdle ||
                       cell.sender_.fault() != link::Fault::kNone;
    ASSERT_TRUE(named) << session;
    ASSERT_FALSE(cell.robot_.receiver().arc_on()) << session;
  }

  std::cout << cell.bus_.fault_counts().total() << " faults injected\n";
  EXPECT_EQ(tally.wrong, 0U);
  EXPECT_EQ(tally.foreign, 0U);
}

}  // namespace
}  // namespace dseam::test
