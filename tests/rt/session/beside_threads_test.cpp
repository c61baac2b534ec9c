// SPDX-License-Identifier: Apache-2.0
// The cycle as one of three threads: the robot at the other end of the bus and the vision run
// beside it, and what they exchange goes through the queues that are made for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/rt/latest_value.hpp"
#include "dseam/rt/queue.hpp"
#include "dseam/rt/weld_session.hpp"
#include "dseam/trajectory/sampler.hpp"
#include "rt/session/futex_counter.hpp"
#include "support/allocation_counter.hpp"
#include "support/arena_owner.hpp"

namespace {

using dseam::hal::CanFrame;
using dseam::rt::WeldSession;
using dseam::trajectory::SetPoint;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kMostBehindNs = 8 * kMs;
#ifdef __SANITIZE_THREAD__
constexpr bool kCountsFutexCalls = false;  // The sanitizer's own locks make them.
constexpr std::uint64_t kCycles = 20'000;  // Each takes a hundred times as long.
#else
constexpr bool kCountsFutexCalls = true;
constexpr std::uint64_t kCycles = 1'000'000;
#endif

using Way = dseam::rt::Queue<CanFrame, 512>;

/// One end of a wire between two threads.
class QueueEnd final : public dseam::hal::CanBus {
 public:
  QueueEnd(Way& out, Way& in) : out_(out), in_(in) {}

 private:
  dseam::Result<> do_send(const CanFrame& frame) noexcept override {
    return out_.push(frame) ? dseam::Result<>() : dseam::Errc::kQueueFull;
  }
  dseam::Result<CanFrame> do_receive(std::chrono::nanoseconds) noexcept override {
    CanFrame frame;
    return in_.pop(frame) ? dseam::Result<CanFrame>(frame) : dseam::Errc::kTimeout;
  }
  dseam::Result<> do_purge() noexcept override { return {}; }
  [[nodiscard]] dseam::hal::BusHealth do_health() const noexcept override {
    dseam::hal::BusHealth health;
    health.state = dseam::hal::BusState::kErrorActive;
    return health;
  }

  Way& out_;
  Way& in_;
};

/// A straight bead that takes `seconds` at 8 mm/s.
std::vector<SetPoint> bead(double seconds) {
  std::vector<dseam::torch::PathPoint> path(static_cast<std::size_t>(16.0 * seconds) + 2);
  for (std::size_t i = 0; i < path.size(); ++i) {
    path[i].s_mm = path[i].pose.p_base.x() = 0.5 * static_cast<double>(i);
    path[i].pose.p_base.x() -= 0.25 * static_cast<double>(path.size());  // Within the workspace.
    path[i].speed_mm_s = 8.0;
    path[i].arc = i > 0;
  }
  dseam::test::ArenaOwner memory(dseam::trajectory::TimeScaling::bytes(path.size()));
  auto timing = dseam::trajectory::TimeScaling::make({}, path.size(), memory.arena()).value();
  (void)timing.run(path);
  auto sampler = dseam::trajectory::Sampler::make(timing.timed_path(), {}, 20'000).value();
  std::vector<SetPoint> points(sampler.size());
  dseam::Buffer<SetPoint> out(points);
  EXPECT_TRUE(sample_all(sampler, out));
  return points;
}

/// Three threads that run as fast as they can, none of them far from the common virtual time.
class ThreadedCell {
 public:
  explicit ThreadedCell(const dseam::torch::TorchPose& home)
      : robot_(config_of(home), robot_end_),
        sender_(dseam::link::Sender::make({}).value()),
        session(WeldSession::make(session_config(), sender_, host_end_).value()),
        robot_thread_([this] { live(robot_ns_, [this](std::int64_t ns) { robot_.step(ns); }); }),
        vision_thread_([this] { live(vision_ns_, [this](std::int64_t ns) { see(ns); }); }) {}
  ~ThreadedCell() {
    ended_ = true;
    robot_thread_.join();
    vision_thread_.join();
  }

  void cycle() {
    const std::int64_t now_ns = now_ns_.load(std::memory_order_relaxed) + kMs;
    now_ns_.store(now_ns, std::memory_order_release);
    while (std::min(robot_ns_.load(), vision_ns_.load()) < now_ns - kMostBehindNs) {
      std::this_thread::yield();
    }
    inputs_.real_time = true;
    inputs_.tick.due_ns = inputs_.tick.woke_ns = now_ns;
    inputs_.vision_silent_ns = heartbeat_.silent_ns(now_ns);
    (void)seen_.read(inputs_.confidence);
    session.step(inputs_);
  }
  bool until(dseam::link::HostState state) {
    for (int i = 0; i < 3000 && sender_.state() != state; ++i) {
      cycle();
    }
    return sender_.state() == state;
  }
  bool start(const std::vector<SetPoint>& points) {
    using H = dseam::link::HostState;
    using E = dseam::rt::SessionEvent;
    (void)session.connect(1, now_ns_);
    if (!until(H::kIdle) || !session.order(E::kScan).ok() ||
        !session.plan(points.front().pose, points).ok()) {
      return false;
    }
    inputs_.operator_enable = true;
    cycle();
    return session.order(E::kArm).ok() && until(H::kArmed) && session.order(E::kLoad).ok() &&
           until(H::kReady) && session.order(E::kStart).ok() && until(H::kRunning);
  }
  [[nodiscard]] std::uint64_t seen() const { return images_; }

 private:
  static dseam::hal::sim::SimRobot::Config config_of(const dseam::torch::TorchPose& home) {
    dseam::hal::sim::SimRobot::Config config;
    config.home = home;
    config.record_points = 0;
    return config;
  }
  static WeldSession::Config session_config() {
    WeldSession::Config config;
    config.vision_limit_ns = 100 * kMs;
    config.arc.workspace.low_mm.setConstant(-1e6);
    config.arc.workspace.high_mm.setConstant(1e6);
    config.motion.workspace = config.arc.workspace;
    return config;
  }
  void see(std::int64_t now_ns) {
    seen_.write(dseam::seam::Confidence::kHigh);
    heartbeat_.beat(now_ns);
    ++images_;
  }
  template <typename Step>
  void live(std::atomic<std::int64_t>& mine_ns, const Step& step) {
    while (!ended_) {
      if (mine_ns >= now_ns_) {
        std::this_thread::yield();
        continue;
      }
      step(mine_ns + kMs);
      mine_ns += kMs;
    }
  }

  std::atomic<std::int64_t> now_ns_{1000 * kMs};
  std::atomic<std::int64_t> robot_ns_{1000 * kMs};
  std::atomic<std::int64_t> vision_ns_{1000 * kMs};
  std::atomic<bool> ended_{false};
  std::atomic<std::uint64_t> images_{0};
  Way to_robot_;
  Way to_host_;
  QueueEnd host_end_{to_robot_, to_host_};
  QueueEnd robot_end_{to_host_, to_robot_};
  dseam::rt::LatestValue<dseam::seam::Confidence> seen_;
  dseam::rt::Heartbeat heartbeat_;
  dseam::hal::sim::SimRobot robot_;
  dseam::link::Sender sender_;
  WeldSession::Inputs inputs_;

 public:
  WeldSession session;

 private:
  std::thread robot_thread_;
  std::thread vision_thread_;
};

TEST(FutexCounter, sees_a_lock_that_has_to_wait) {
  std::mutex mutex;
  std::uint64_t calls = 0;
  bool counting = false;
  mutex.lock();
  std::thread waits([&] {
    const dseam::test::FutexCounter counter;
    counting = counter.counting();
    const bool had = mutex.try_lock();
    if (!had) {
      mutex.lock();
    }
    calls = counter.count();
    mutex.unlock();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  mutex.unlock();
  waits.join();

  EXPECT_TRUE(counting);
  EXPECT_GT(calls, 0U);
}

TEST(BesideThreads, a_million_cycles_make_no_futex_call_and_allocate_nothing) {
  const auto points = bead(1e-3 * static_cast<double>(kCycles) + 5.0);
  std::uint64_t futex_calls = 0;
  std::uint64_t allocations = 1;
  std::uint64_t images = 0;
  dseam::rt::Fault fault = dseam::rt::Fault::kNone;
  bool counting = false;
  bool started = false;

  std::thread cycle_thread([&] {
    ThreadedCell cell(points.front().pose);
    started = cell.start(points);
    for (int i = 0; i < 1000; ++i) {
      cell.cycle();
    }
    const dseam::test::ThreadAllocationCounter allocated;
    std::optional<dseam::test::FutexCounter> counter;
    if (kCountsFutexCalls) {
      counter.emplace();
    }
    for (std::uint64_t i = 0; i < kCycles; ++i) {
      cell.cycle();
    }
    futex_calls = counter ? counter->count() : 0;
    allocations = allocated.count();
    counting = counter && counter->counting();
    fault = cell.session.fault();
    images = cell.seen();
    EXPECT_EQ(cell.session.state(), dseam::rt::SessionState::kRunning);
  });
  cycle_thread.join();

  EXPECT_TRUE(started);
  EXPECT_EQ(counting, kCountsFutexCalls);
  EXPECT_EQ(fault, dseam::rt::Fault::kNone) << name(fault);
  EXPECT_EQ(futex_calls, 0U);
  EXPECT_EQ(allocations, 0U);
  EXPECT_GE(images, kCycles);
}

}  // namespace
