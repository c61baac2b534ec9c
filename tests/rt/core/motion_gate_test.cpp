// SPDX-License-Identifier: Apache-2.0
#include "dseam/rt/motion_gate.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include "support/allocation_counter.hpp"

namespace {

using dseam::rt::Fault;
using dseam::rt::MotionGate;
using dseam::trajectory::SetPoint;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Half a second along x with a smooth start and end, every 10 ms.
std::vector<SetPoint> smooth_run() {
  std::vector<SetPoint> points(51);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = static_cast<double>(i) / 50.0;
    points[i].t_us = static_cast<std::uint32_t>(10'000 * i);
    points[i].pose.p_base.x() = 20.0 * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  }
  return points;
}

MotionGate gate(std::function<void(MotionGate::Config&)> set = [](auto&) {}) {
  MotionGate::Config config;
  set(config);
  return MotionGate::make(config).value();
}

TEST(MotionGate, a_smooth_run_from_where_the_torch_is_passes) {
  const auto points = smooth_run();
  MotionGate motion = gate();
  const dseam::test::AllocationCounter counter;

  const auto verdict = motion.check_all({}, points);

  EXPECT_EQ(verdict.fault, Fault::kNone);
  EXPECT_EQ(counter.count(), 0U);
}

TEST(MotionGate, each_breach_alone_is_named_with_its_place) {
  const struct {
    Fault fault;
    std::function<void(MotionGate::Config&)> limit;
    std::function<void(SetPoint&)> spoil;  // The set point with index 20.
  } cases[] = {
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.pose.p_base.y() = kNan; }},
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.pose.q_base_torch.w() = kNan; }},
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.pose.q_base_torch.w() = 0.5; }},
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.speed_mm_s = kNan; }},
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.wire_feed_m_min = kNan; }},
      {Fault::kSetPointNotFinite, [](auto&) {}, [](auto& p) { p.voltage_v = kNan; }},
      {Fault::kOutsideWorkspace, [](auto&) {}, [](auto& p) { p.pose.p_base.z() = 1e20; }},
      {Fault::kSetPointOrder, [](auto&) {}, [](auto& p) { p.t_us -= 10'000; }},
      {Fault::kSetPointJump, [](auto&) {}, [](auto& p) { p.pose.p_base.y() = 26.0; }},
      {Fault::kSetPointJump, [](auto&) {},
       [](auto& p) { p.pose.q_base_torch = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()); }},
      {Fault::kSetPointSpeed, [](auto& c) { c.max_speed_mm_s = 200.0; },
       [](auto& p) { p.pose.p_base.y() = 2.2; }},
      {Fault::kSetPointAcceleration, [](auto&) {}, [](auto& p) { p.pose.p_base.y() = 0.4; }},
      {Fault::kSetPointJerk, [](auto&) {}, [](auto& p) { p.pose.p_base.y() = 0.08; }},
      {Fault::kSetPointTurn, [](auto&) {},
       [](auto& p) { p.pose.q_base_torch = Eigen::AngleAxisd(0.031, Eigen::Vector3d::UnitX()); }}};
  for (const auto& c : cases) {
    auto points = smooth_run();
    c.spoil(points[20]);
    MotionGate motion = gate(c.limit);

    const auto verdict = motion.check_all({}, points);

    EXPECT_EQ(verdict.fault, c.fault) << dseam::rt::name(c.fault);
    EXPECT_EQ(verdict.index, 20U) << dseam::rt::name(c.fault);
  }
}

TEST(MotionGate, a_start_that_is_not_where_the_torch_is_is_a_jump) {
  const auto points = smooth_run();
  dseam::torch::TorchPose aside;
  aside.p_base.x() = 1.1;
  dseam::torch::TorchPose turned;
  turned.q_base_torch = Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitZ());
  MotionGate motion = gate();

  EXPECT_EQ(motion.check_all(aside, points).fault, Fault::kSetPointJump);
  EXPECT_EQ(motion.check_all(turned, points).fault, Fault::kSetPointJump);
  EXPECT_EQ(motion.check_all(turned, points).index, 0U);
}

TEST(MotionGate, a_run_that_ends_in_motion_is_refused_at_its_last_point) {
  auto points = smooth_run();
  points.resize(26);  // Cut off in the middle, where it is fastest.
  MotionGate motion = gate();

  const auto verdict = motion.check_all({}, points);

  EXPECT_EQ(verdict.fault, Fault::kSetPointEnd);
  EXPECT_EQ(verdict.index, 25U);
}

TEST(MotionGate, a_run_that_ends_while_it_brakes_too_hard_to_stand_is_refused) {
  const auto points = smooth_run();
  MotionGate motion = gate([](auto& c) { c.max_jerk_mm_s3 = 2000.0; });
  MotionGate cut = gate([](auto& c) { c.max_jerk_mm_s3 = 10000.0; });

  // The run itself needs 9600 mm/s3 and keeps them to its end; without its last point it does not.
  EXPECT_EQ(motion.check_all({}, points).fault, Fault::kSetPointJerk);
  EXPECT_EQ(cut.check_all({}, points).fault, Fault::kNone);
  EXPECT_EQ(cut.check_all({}, std::span(points).first(49)).fault, Fault::kSetPointEnd);
}

TEST(MotionGate, a_single_point_stands_where_the_torch_is) {
  const std::vector<SetPoint> points(1);
  MotionGate motion = gate();

  EXPECT_EQ(motion.check_all({}, points).fault, Fault::kNone);
  EXPECT_EQ(motion.check_all({}, {}).fault, Fault::kNone);
}

TEST(MotionGate, point_by_point_a_turn_that_is_too_fast_is_named_too) {
  MotionGate motion = gate([](auto& c) { c.max_turn_rad_s = 1.0; });
  SetPoint point;
  motion.restart({});
  (void)motion.check(point);
  point.t_us = 10'000;
  point.pose.q_base_torch = Eigen::AngleAxisd(0.0099, Eigen::Vector3d::UnitZ());
  const Fault slow = motion.check(point);
  point.t_us = 20'000;
  point.pose.q_base_torch = Eigen::AngleAxisd(0.0200, Eigen::Vector3d::UnitZ());
  const Fault fast = motion.check(point);

  EXPECT_EQ(slow, Fault::kNone);
  EXPECT_EQ(fast, Fault::kSetPointTurn);
}

TEST(MotionGate, limits_that_are_none_are_refused) {
  const auto refused = [](auto set) {
    MotionGate::Config config;
    set(config);
    return !MotionGate::make(config).ok();
  };

  EXPECT_TRUE(refused([](auto& c) { c.max_start_mm = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_step_rad = kNan; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_speed_mm_s = -1.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.max_jerk_mm_s3 = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](auto& c) { c.max_turn_rad_s = 0.0; }));
  EXPECT_TRUE(refused([](auto& c) { c.workspace.low_mm.y() = 1e9; }));
}

}  // namespace
