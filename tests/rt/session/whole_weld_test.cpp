// SPDX-License-Identifier: Apache-2.0
// From a seam to the reference robot: planned, timed and streamed with every gate at its defaults.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>

#include "dseam/hal/fake/manual_clock.hpp"
#include "dseam/hal/sim/sim_bus.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/rt/weld_session.hpp"
#include "dseam/torch/path_planner.hpp"
#include "dseam/torch/torch_planner.hpp"
#include "dseam/trajectory/sampler.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"
#include "support/shapes/analytic_saddle.hpp"

namespace {

using dseam::rt::SessionEvent;
using dseam::rt::SessionState;
using dseam::rt::WeldSession;
using dseam::test::Saddle;
using dseam::torch::PathPlanner;
using dseam::trajectory::SetPoint;

constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<SetPoint> set_points(const Saddle& saddle, const PathPlanner::Config& config,
                                 const dseam::torch::TorchPose& now, std::uint32_t period_us) {
  constexpr std::size_t kRoom = 60'000;
  dseam::test::ArenaOwner owner(dseam::torch::TorchPlanner::bytes(1000) +
                                dseam::trajectory::TimeScaling::bytes(kRoom));
  const auto seam = saddle.points(720);
  std::vector<dseam::torch::TorchPoint> torch_storage(2000);
  std::vector<dseam::torch::PathPoint> path_storage(kRoom);
  dseam::Buffer<dseam::torch::TorchPoint> torch(torch_storage);
  dseam::Buffer<dseam::torch::PathPoint> path(path_storage);
  auto torch_planner = dseam::torch::TorchPlanner::make({}, 1000, owner.arena()).value();
  const auto planned = torch_planner.run(dseam::test::view_of(seam), torch);
  auto planner = PathPlanner::make(config).value();
  EXPECT_EQ(planner.run_from(now, {torch.view(), planned.length_mm, true}, path).state,
            PathPlanner::State::kPlanned);
  auto timing = dseam::trajectory::TimeScaling::make({}, kRoom, owner.arena()).value();
  EXPECT_EQ(timing.run(path.view()).state, dseam::trajectory::TimeScaling::State::kTimed);
  auto sampler = dseam::trajectory::Sampler::make(timing.timed_path(), {}, period_us).value();
  std::vector<SetPoint> points(sampler.size());
  dseam::Buffer<SetPoint> out(points);
  EXPECT_TRUE(sample_all(sampler, out));
  return points;
}

/// Host, bus and robot under virtual time, one millisecond a cycle.
class Cell {
 public:
  explicit Cell(const dseam::torch::TorchPose& home, const WeldSession::Config& config = {},
                std::size_t record_points = 100'000)
      : host_end_(bus_.connect()),
        robot_(robot_config(home, record_points), bus_.connect()),
        sender_(dseam::link::Sender::make({}).value()),
        session(WeldSession::make(config, sender_, host_end_).value()) {
    inputs.real_time = true;
  }

  void cycle() {
    clock_.advance(1'000'000);
    robot_.step(clock_.now_ns());
    inputs.tick.due_ns = inputs.tick.woke_ns = clock_.now_ns();
    session.step(inputs);
  }
  bool until(dseam::link::HostState state, int most) {
    while (sender_.state() != state && session.fault() == dseam::rt::Fault::kNone && most-- > 0) {
      cycle();
    }
    return sender_.state() == state;
  }
  bool start(const std::vector<SetPoint>& points, std::uint32_t id) {
    using H = dseam::link::HostState;
    inputs.operator_enable = false;
    (void)session.connect(id, clock_.now_ns());
    if (!until(H::kIdle, 1000) || !session.order(SessionEvent::kScan).ok() ||
        !session.plan(points.front().pose, points).ok()) {
      return false;
    }
    inputs.operator_enable = true;
    cycle();
    return session.order(SessionEvent::kArm).ok() && until(H::kArmed, 500) &&
           session.order(SessionEvent::kLoad).ok() && until(H::kReady, 2000) &&
           session.order(SessionEvent::kStart).ok();
  }
  bool weld(const std::vector<SetPoint>& points, std::uint32_t id, int most) {
    if (!start(points, id)) {
      return false;
    }
    while (session.state() != SessionState::kIdle && session.fault() == dseam::rt::Fault::kNone &&
           most-- > 0) {
      cycle();
    }
    return session.state() == SessionState::kIdle;
  }
  [[nodiscard]] const dseam::hal::sim::SimRobot& robot() const { return robot_; }

 private:
  static dseam::hal::sim::SimRobot::Config robot_config(const dseam::torch::TorchPose& home,
                                                        std::size_t record_points) {
    dseam::hal::sim::SimRobot::Config config;
    config.home = home;
    config.record_points = record_points;
    return config;
  }

  dseam::hal::fake::ManualClock clock_{1'000'000'000};
  dseam::hal::sim::SimBus bus_{{}, clock_};
  dseam::hal::CanBus& host_end_;
  dseam::hal::sim::SimRobot robot_;
  dseam::link::Sender sender_;

 public:
  WeldSession session;
  WeldSession::Inputs inputs;
};

TEST(WholeWeld, every_kind_of_path_is_welded_to_its_end_without_a_gate_in_its_way) {
  PathPlanner::Config weave;
  weave.passes[0].weave = {dseam::torch::WeaveShape::kSine, 2.0, 6.0};
  PathPlanner::Config passes;
  passes.num_passes = 3;
  passes.passes[1].across_mm = 3.0;
  passes.passes[2].out_mm = 3.0;
  passes.max_wrist_turn_rad = 320 * kDegree;
  const PathPlanner::Config configs[] = {{}, weave, passes};
  const Saddle saddles[] = {{100.0, 40.0, 65 * kDegree, 15.0}, {60.0, 20.0, 75 * kDegree, 20.0}};
  dseam::torch::TorchPose home;
  home.p_base = {150.0, -80.0, 300.0};
  home.q_base_torch = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
  std::uint32_t id = 1;
  for (const Saddle& saddle : saddles) {
    for (const PathPlanner::Config& config : configs) {
      const auto points = set_points(saddle, config, home, 10'000);
      Cell cell(home);

      const bool done = cell.weld(points, id++, 300'000);

      EXPECT_TRUE(done) << name(cell.session.state()) << " " << name(cell.session.fault())
                        << " after " << cell.robot().executed().size() << " of " << points.size();
      EXPECT_EQ(cell.robot().executed().size(), points.size());
      const auto burnt =
          std::count_if(cell.robot().executed().begin(), cell.robot().executed().end(),
                        [](const auto& p) { return p.due.arc_on; });
      const auto asked =
          std::count_if(points.begin(), points.end(), [](const SetPoint& p) { return p.arc; });
      EXPECT_EQ(burnt, asked);
    }
  }
}

rusage usage_of_this_thread() {
  rusage usage{};
  (void)getrusage(RUSAGE_THREAD, &usage);
  return usage;
}

TEST(WholeWeld, a_million_cycles_allocate_nothing_fault_in_no_page_and_wait_for_nobody) {
  PathPlanner::Config slow;
  slow.num_passes = 3;
  for (dseam::torch::Pass& pass : slow.passes) {
    pass.speed_mm_s = 0.6;
  }
  slow.max_wrist_turn_rad = 20.0;
  dseam::torch::TorchPose home;
  home.p_base = {150.0, -80.0, 300.0};
  const auto points = set_points({100.0, 30.0, 90 * kDegree, 0.0}, slow, home, 20'000);
  WeldSession::Config config;
  config.arc.max_standing_ns = 10'000'000'000;
  Cell cell(home, config, 0);  // A record would grow into pages of its own.
  ASSERT_TRUE(cell.start(points, 1));
  for (int i = 0; i < 10'000; ++i) {
    cell.cycle();
  }
  const dseam::test::AllocationCounter counter;
  const rusage before = usage_of_this_thread();

  for (int i = 0; i < 1'000'000; ++i) {
    cell.cycle();
  }

  const rusage after = usage_of_this_thread();
  EXPECT_EQ(cell.session.state(), SessionState::kRunning) << name(cell.session.fault());
  EXPECT_EQ(counter.count(), 0U);
  EXPECT_EQ(after.ru_majflt - before.ru_majflt, 0);
  EXPECT_EQ(after.ru_minflt - before.ru_minflt, 0);
  EXPECT_EQ(after.ru_nvcsw - before.ru_nvcsw, 0);
}

}  // namespace
