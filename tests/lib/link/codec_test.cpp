// SPDX-License-Identifier: Apache-2.0
#include "dseam/link/codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "dseam/base/random.hpp"
#include "dseam/link/crc.hpp"

namespace dseam::link {
namespace {

double between(Pcg32& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

Point some_point(Pcg32& random) {
  Point point;
  point.session = random.next();
  point.trajectory = static_cast<std::uint16_t>(random.below(65536));
  point.seq = static_cast<std::uint16_t>(random.below(65536));
  point.first = random.below(2) == 1;
  point.last = random.below(2) == 1;
  trajectory::SetPoint& set_point = point.set_point;
  set_point.t_us = random.next();
  set_point.pose.p_base = {between(random, -3000, 3000), between(random, -3000, 3000),
                           between(random, -3000, 3000)};
  set_point.pose.q_base_torch = Eigen::Quaterniond(between(random, -1, 1), between(random, -1, 1),
                                                   between(random, -1, 1), between(random, -1, 1))
                                    .normalized();
  set_point.s_mm = between(random, 0, 5000);
  set_point.speed_mm_s = between(random, 0, 650);
  set_point.wire_feed_m_min = between(random, 0, 30);
  set_point.voltage_v = between(random, 0, 50);
  set_point.segment = static_cast<torch::Segment>(random.below(7));
  set_point.arc = random.below(2) == 1;
  set_point.gas = random.below(2) == 1;
  set_point.wire = random.below(2) == 1;
  set_point.pass = static_cast<std::uint8_t>(random.below(256));
  set_point.schedule = static_cast<std::uint8_t>(random.below(256));
  return point;
}

TEST(Codec, a_point_comes_back_within_half_a_count_of_each_unit) {
  Pcg32 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Point sent = some_point(random);

    const Result<Frame> frame = encode(sent);
    ASSERT_TRUE(frame.ok());
    const Result<Point> decoded = decode_point(frame.value());
    ASSERT_TRUE(decoded.ok());

    const Point& got = decoded.value();
    EXPECT_EQ(got.session, sent.session);
    EXPECT_EQ(got.trajectory, sent.trajectory);
    EXPECT_EQ(got.seq, sent.seq);
    EXPECT_EQ(got.first, sent.first);
    EXPECT_EQ(got.last, sent.last);
    const trajectory::SetPoint& a = sent.set_point;
    const trajectory::SetPoint& b = got.set_point;
    EXPECT_EQ(a.t_us, b.t_us);
    EXPECT_LE((a.pose.p_base - b.pose.p_base).cwiseAbs().maxCoeff(), 0.000501);
    EXPECT_LE(a.pose.q_base_torch.angularDistance(b.pose.q_base_torch), 7e-5);
    EXPECT_NEAR(a.s_mm, b.s_mm, 0.000501);
    EXPECT_NEAR(a.speed_mm_s, b.speed_mm_s, 0.00501);
    EXPECT_NEAR(a.wire_feed_m_min, b.wire_feed_m_min, 0.00501);
    EXPECT_NEAR(a.voltage_v, b.voltage_v, 0.00501);
    EXPECT_EQ(a.segment, b.segment);
    EXPECT_EQ(a.arc, b.arc);
    EXPECT_EQ(a.gas, b.gas);
    EXPECT_EQ(a.wire, b.wire);
    EXPECT_EQ(a.pass, b.pass);
    EXPECT_EQ(a.schedule, b.schedule);
  }
}

TEST(Codec, a_point_that_is_no_number_or_does_not_fit_is_not_encoded) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite, 1e20, -1e20, 2147484.0}) {
    Point point;
    point.set_point.pose.p_base.y() = bad;
    EXPECT_FALSE(encode(point).ok()) << bad;
  }
  for (const double bad : {nan, infinite, -0.01, 655.36}) {
    Point point;
    point.set_point.speed_mm_s = bad;
    EXPECT_FALSE(encode(point).ok()) << bad;
  }
  Point point;
  point.set_point.pose.q_base_torch.z() = nan;
  EXPECT_FALSE(encode(point).ok());
}

TEST(Codec, a_quaternion_that_is_no_rotation_is_refused) {
  Frame frame = encode(Point{}).value();
  frame.data[24] = std::byte{0};
  frame.data[25] = std::byte{0};

  EXPECT_FALSE(decode_point(frame).ok());
}

TEST(Codec, a_status_comes_back_as_it_was) {
  Status sent;
  sent.session = 0xDEADBEEF;
  sent.state = RobotState::kStopping;
  sent.arc_on = true;
  sent.ack_seq = 65535;
  sent.verified_seq = 65520;
  sent.exec_seq = 1;
  sent.credit = 1024;
  sent.buffer_ms = 777;
  sent.trajectory = 42;
  sent.fault = Fault::kStarved;
  sent.robot_time_us = 0xFEDCBA987654ULL;

  const Result<Status> decoded = decode_status(encode(sent));

  ASSERT_TRUE(decoded.ok());
  const Status& got = decoded.value();
  EXPECT_EQ(got.session, sent.session);
  EXPECT_EQ(got.state, sent.state);
  EXPECT_EQ(got.arc_on, sent.arc_on);
  EXPECT_EQ(got.ack_seq, sent.ack_seq);
  EXPECT_EQ(got.verified_seq, sent.verified_seq);
  EXPECT_EQ(got.exec_seq, sent.exec_seq);
  EXPECT_EQ(got.credit, sent.credit);
  EXPECT_EQ(got.buffer_ms, sent.buffer_ms);
  EXPECT_EQ(got.trajectory, sent.trajectory);
  EXPECT_EQ(got.fault, sent.fault);
  EXPECT_EQ(got.robot_time_us, sent.robot_time_us);
}

TEST(Codec, each_condition_of_the_robot_comes_back_alone) {
  const RobotCondition conditions[] = {{},
                                       {.enabled = true},
                                       {.protective_stop = true},
                                       {.emergency_stop = true},
                                       {true, true, true}};
  for (const RobotCondition& condition : conditions) {
    Status sent;
    sent.condition = condition;

    const Result<Status> decoded = decode_status(encode(sent));

    ASSERT_TRUE(decoded.ok());
    EXPECT_EQ(decoded.value().condition, condition);
  }
}

TEST(Codec, a_reserved_condition_of_the_robot_is_bad_data) {
  for (const unsigned bit : {0x08U, 0x10U, 0x20U, 0x40U, 0x80U}) {
    Frame status = encode(Status{});
    status.data[28] = static_cast<std::byte>(bit);

    EXPECT_FALSE(decode_status(status).ok());
  }
}

TEST(Codec, an_enumerator_that_does_not_exist_is_bad_data) {
  Frame status = encode(Status{});
  Frame command = encode(Command{});
  Frame nack = encode(Nack{});
  Frame abort = encode(Abort{});
  status.data[3] = std::byte{0x0F};
  command.data[3] = std::byte{0x07};
  nack.data[3] = std::byte{0x03};
  abort.data[2] = std::byte{0xFF};

  EXPECT_FALSE(decode_status(status).ok());
  EXPECT_FALSE(decode_command(command).ok());
  EXPECT_FALSE(decode_nack(nack).ok());
  EXPECT_FALSE(decode_abort(abort).ok());
}

TEST(Codec, the_dictionary_is_the_one_this_library_was_built_from) {
  std::ifstream file(DSEAM_DICTIONARY, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};

  ASSERT_FALSE(text.empty());
  EXPECT_EQ(crc32(std::as_bytes(std::span(text))), kDictionaryCrc);
}

TEST(Codec, every_message_of_another_length_is_bad_data) {
  for (std::uint8_t size = 0; size <= 64; ++size) {
    Frame frame;
    frame.size_bytes = size;
    EXPECT_EQ(decode_abort(frame).ok(), size == 8);
    EXPECT_EQ(decode_command(frame).ok(), size == 16);
    EXPECT_EQ(decode_status(frame).ok(), size == 32);
    EXPECT_EQ(decode_trajectory(frame).ok(), size == 32);
    EXPECT_EQ(decode_nack(frame).ok(), size == 12);
    EXPECT_EQ(decode_hello(frame).ok(), size == 32);
    EXPECT_FALSE(decode_point(frame).ok());
    EXPECT_FALSE(decode_pose(frame).ok());
  }
}

}  // namespace
}  // namespace dseam::link
