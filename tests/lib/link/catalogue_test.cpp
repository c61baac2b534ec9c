// SPDX-License-Identifier: Apache-2.0
// What a bus can do to a weld, fault by fault: each has its named end.
#include <gtest/gtest.h>

#include "dseam/link/codec.hpp"
#include "lib/link/loopback.hpp"

namespace dseam::link {
namespace {

class Catalogue : public LoopbackCell, public ::testing::Test {
 protected:
  static MessageId message_of(const Frame& frame) {
    return static_cast<MessageId>(frame.id - Addressing{}.base_id);
  }
  void step_until_arc() {
    for (int i = 0; i < 3000 && !robot_.arc_on(); ++i) {
      step();
    }
    ASSERT_TRUE(robot_.arc_on());
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      step();
    }
  }
};

TEST_F(Catalogue, a_session_replayed_from_its_first_frame_to_its_last_moves_nothing) {
  std::vector<Frame> recorded;
  recorded.reserve(100'000);
  on_the_way_ = [&recorded](Frame& frame) {
    recorded.push_back(frame);
    return true;
  };
  const auto points = straight_weld(300, 4000);
  ASSERT_TRUE(prepare_and_start(points));
  ASSERT_TRUE(run_until(HostState::kDone));
  host_to_robot_ = false;
  steps(300);
  ASSERT_EQ(robot_.state(), RobotState::kSafe);
  const std::size_t executed_before = executed_.size();

  for (const Frame& frame : recorded) {
    robot_.on_frame(frame, now_ns_);
    steps(1);
    ASSERT_EQ(robot_.state(), RobotState::kSafe);
  }

  EXPECT_EQ(executed_.size(), executed_before);
  EXPECT_FALSE(robot_.arc_on());
}

TEST_F(Catalogue, a_robot_that_lost_its_session_to_another_host_ignores_the_old_ones_replay) {
  std::vector<Frame> recorded;
  recorded.reserve(100'000);
  on_the_way_ = [&recorded](Frame& frame) {
    recorded.push_back(frame);
    return true;
  };
  const auto points = straight_weld(300, 4000);
  ASSERT_TRUE(prepare_and_start(points));
  host_.abort(Fault::kAborted, now_ns_);
  steps(400);
  on_the_way_ = nullptr;
  ASSERT_TRUE(host_.connect(1234, now_ns_).ok());
  ASSERT_TRUE(run_until(HostState::kIdle));
  const std::size_t executed_before = executed_.size();

  for (const Frame& frame : recorded) {
    robot_.on_frame(frame, now_ns_);
    steps(1);
  }

  EXPECT_EQ(robot_.session(), 1234U);
  EXPECT_EQ(executed_.size(), executed_before);
}

TEST_F(Catalogue, three_damaged_commands_in_ten_stop_the_robot) {
  ASSERT_TRUE(prepare_and_start(straight_));
  step_until_arc();
  int damaged = 0;
  on_the_way_ = [&damaged](Frame& frame) {
    if (message_of(frame) == MessageId::kCommand && damaged < 3) {
      frame.data[12] ^= std::byte{1};
      ++damaged;
    }
    return true;
  };

  steps(30);

  EXPECT_EQ(robot_.fault(), Fault::kE2eInvalid);
  EXPECT_FALSE(robot_.arc_on());
  EXPECT_EQ(host_.fault(), Fault::kPeerFault);
}

TEST_F(Catalogue, a_command_of_another_session_while_armed_stops_the_robot) {
  ASSERT_TRUE(prepare_and_start(straight_));
  step_until_arc();
  std::vector<Frame> storage(4);
  Buffer<Frame> other(storage);
  Transmitter stranger({});
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(stranger.send(MessageId::kCommand,
                              encode(Command{4711, Request::kStart, true, 1, 99'000'000}), other));
  }

  // Its counter fits at one of three tries at the latest: the first one moves it there.
  for (const Frame& frame : other.view()) {
    robot_.on_frame(frame, now_ns_);
  }

  EXPECT_EQ(robot_.fault(), Fault::kForeignSession);
  EXPECT_FALSE(robot_.arc_on());
}

TEST_F(Catalogue, points_that_stay_away_end_in_a_stop_on_the_path_that_is_left) {
  ASSERT_TRUE(prepare_and_start(straight_));
  step_until_arc();
  on_the_way_ = [](Frame& frame) {
    return message_of(frame) != MessageId::kPoint && message_of(frame) != MessageId::kTrajectory;
  };

  for (int i = 0; i < 5000 && robot_.state() == RobotState::kRunning; ++i) {
    step();
  }

  EXPECT_EQ(robot_.fault(), Fault::kStarved);
  EXPECT_FALSE(robot_.arc_on());
  EXPECT_TRUE(robot_.moving());
  steps(250);
  EXPECT_FALSE(robot_.moving());
  EXPECT_LT(robot_.points().executed(), robot_.points().verified());
}

TEST_F(Catalogue, points_forged_with_the_right_protection_are_thrown_away_by_the_next_mark) {
  int forged = 0;
  on_the_way_ = [&forged](Frame& frame) {
    if (message_of(frame) == MessageId::kPoint && forged < 5) {
      frame.data[14] ^= std::byte{4};  // X, by a quarter of a metre.
      protect_p05(frame.bytes(), data_id_of(MessageId::kPoint), counter_p05(frame.bytes()));
      ++forged;
    }
    return true;
  };

  ASSERT_TRUE(prepare_and_start(straight_));
  ASSERT_TRUE(run_until(HostState::kDone, 20'000));

  EXPECT_EQ(forged, 5);
  EXPECT_GE(robot_.report().bad_marks, 1U);
  ASSERT_EQ(executed_.size(), straight_.size());
  for (std::size_t i = 0; i < executed_.size(); ++i) {
    ASSERT_NEAR(executed_[i].point.pose.p_base.x(), straight_[i].pose.p_base.x(), 0.001);
  }
}

TEST_F(Catalogue, a_host_that_misses_its_own_cycle_says_so_and_does_not_go_on) {
  ASSERT_TRUE(prepare_and_start(straight_));
  step_until_arc();

  now_ns_ += 50'000'000;
  step();

  EXPECT_EQ(host_.fault(), Fault::kOverrun);
  EXPECT_FALSE(robot_.arc_on());
}

TEST_F(Catalogue, arc_off_leaves_in_the_cycle_of_the_fault_and_first) {
  ASSERT_TRUE(prepare_and_start(straight_));
  step_until_arc();

  host_.abort(Fault::kAborted, now_ns_);
  frames_.clear();
  host_.poll(now_ns_, frames_);

  ASSERT_FALSE(frames_.empty());
  EXPECT_EQ(message_of(frames_[0]), MessageId::kAbort);
  robot_.on_frame(frames_[0], now_ns_);
  EXPECT_FALSE(robot_.arc_on());
}

}  // namespace
}  // namespace dseam::link
