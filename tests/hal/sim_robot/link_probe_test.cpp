// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/bus/link_probe.hpp"

#include <gtest/gtest.h>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/sim/sim_robot.hpp"

namespace dseam::test {
namespace {

/// Time in which a robot lives, or none does.
class CellClock final : public hal::Clock {
 public:
  hal::fake::ManualClock time{1'000'000'000};
  hal::sim::SimRobot* robot = nullptr;

 private:
  std::int64_t do_now_ns() noexcept override { return time.now_ns(); }
  void do_sleep_until(std::int64_t deadline_ns) noexcept override {
    time.advance(deadline_ns - time.now_ns());
    if (robot != nullptr) {
      robot->step(time.now_ns());
    }
  }
};

class LinkProbeTest : public ::testing::Test {
 protected:
  hal::LinkProbe probe(const link::Sender::Config& config = {}) {
    return hal::probe_link(host_, clock_, config, 77);
  }

  CellClock clock_;
  hal::sim::SimBus bus_{{}, clock_.time};
  hal::CanBus& host_ = bus_.connect();
  hal::sim::SimRobot robot_{{}, bus_.connect()};
};

TEST_F(LinkProbeTest, a_robot_that_answers_is_described_and_left_as_it_was) {
  clock_.robot = &robot_;

  const hal::LinkProbe answer = probe();

  EXPECT_EQ(answer.fault, link::Fault::kNone) << link::name(answer.fault);
  EXPECT_GT(answer.answer_ns, 0);
  EXPECT_LT(answer.answer_ns, 500'000'000);
  EXPECT_NEAR(static_cast<double>(answer.statuses), 50.0, 5.0);
  EXPECT_GT(answer.peer.buffer_points, 0);
  EXPECT_FALSE(robot_.receiver().arc_on());
  EXPECT_TRUE(robot_.executed().empty());
}

TEST_F(LinkProbeTest, a_silent_bus_is_named_after_the_time_an_order_has) {
  const std::int64_t start_ns = clock_.time.now_ns();

  const hal::LinkProbe answer = probe();

  EXPECT_EQ(answer.fault, link::Fault::kNoPeer);
  EXPECT_EQ(answer.answer_ns, 0);
  EXPECT_LT(clock_.time.now_ns() - start_ns, 5'000'000'000);
}

TEST_F(LinkProbeTest, a_link_that_cannot_be_is_refused_without_a_frame) {
  link::Sender::Config config;
  config.armed_period_ns = 0;

  EXPECT_EQ(probe(config).fault, link::Fault::kRefused);
  EXPECT_EQ(host_.health().sent, 0U);
}

}  // namespace
}  // namespace dseam::test
