// SPDX-License-Identifier: Apache-2.0
#include "robot/last_words.hpp"

#include <gtest/gtest.h>
#include <linux/can.h>

#include <bit>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "hal/sim_robot/cell.hpp"

namespace dseam::program {
namespace {

TEST(LastWords, turn_the_arc_of_a_welding_robot_off_whatever_its_session) {
  test::LinkCell cell;
  const auto points = test::round_weld(5000, 1000);
  const link::WeldOrder order{9, 1, points, true};
  for (int i = 0; i < 3000 && !cell.robot_.receiver().arc_on(); ++i) {
    (void)cell.step(order);
  }
  ASSERT_TRUE(cell.robot_.receiver().arc_on());
  hal::CanBus& stranger = cell.bus_.connect();
  const auto raw = std::bit_cast<can_frame>(LastWords::abort_frame({}));
  hal::CanFrame frame;
  frame.id = raw.can_id;
  frame.size_bytes = raw.can_dlc;
  std::memcpy(frame.data.data(), raw.data, raw.can_dlc);

  ASSERT_TRUE(stranger.send(frame).ok());
  (void)cell.step(order);
  (void)cell.step(order);

  EXPECT_FALSE(cell.robot_.receiver().arc_on());
  EXPECT_EQ(cell.robot_.receiver().fault(), link::Fault::kAborted);
}

}  // namespace
}  // namespace dseam::program
