// SPDX-License-Identifier: Apache-2.0
// The whole way on the real clock: a camera of the kernel, the decoder in a thread of its own, the
// cycle with a running weld link, the kernel's CAN. Reported, not judged: an emulator that keeps
// its own time promises no latency. tests/vm/run.sh compares two runs under counted instructions,
// in which there is no such time but what the instructions took.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdio>
#include <thread>
#include <vector>

#include "dseam/depth/frame_decoder.hpp"
#include "dseam/hal/sim/sim_robot.hpp"
#include "dseam/hal/socketcan/socketcan_bus.hpp"
#include "dseam/rt/cycle.hpp"
#include "dseam/rt/latest_value.hpp"
#include "dseam/rt/linux/monotonic_clock.hpp"
#include "dseam/rt/linux/thread_setup.hpp"
#include "dseam/rt/timing/cycle_times.hpp"
#include "hal/sim_robot/cell.hpp"
#include "vm/vivid/vivid.hpp"

namespace dseam::test {
namespace {

using hal::socketcan::SocketCanBus;
using namespace std::chrono_literals;

constexpr std::size_t kPoints = 6000;  // Of a millisecond each.
constexpr std::uint32_t kNewsId = 0x300;

/// What the vision thread makes of a frame.
struct News {
  std::int64_t captured_ns = 0;
  std::uint64_t valid_pixels = 0;
};

std::unique_ptr<SocketCanBus> open_vcan() {
  auto opened = SocketCanBus::open("vcan0", {});
  EXPECT_TRUE(opened.ok()) << name(opened.error());
  return std::move(opened.value());
}

void set_up(int priority) {
  const auto granted = rt::set_up_thread({.priority = priority});
  EXPECT_TRUE(granted.ok() && granted.value().real_time());
  rt::prefault_stack();
}

/// Everything begins at an even time, so that two runs meet the kernel's clocks alike.
void wait_for_even_second(hal::Clock& clock) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  clock.sleep_until((clock.now_ns() / kSecondNs + 2) * kSecondNs);
}

class LatencyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(Vivid::set("Timestamp Source", 1));  // Start of exposure: not in the future.
    std::string problem;
    auto opened =
        hal::v4l2::V4l2Camera::open(Vivid::config(), hal::v4l2::linux_v4l2_sys(), problem);
    ASSERT_TRUE(opened.ok()) << problem;
    camera_ = std::move(opened.value());
    wait_for_even_second(clock_);
    ASSERT_TRUE(camera_->start(hal::FrameMode::kLatest).ok());
    robot_.emplace(hal::sim::SimRobot::Config{}, *robot_bus_);
    robot_thread_ = std::thread([this] {
      set_up(70);
      rt::MonotonicClock clock;
      serve(*robot_, clock, 1'000'000, done_);
    });
    vision_thread_ = std::thread([this] { see(); });
  }
  void TearDown() override {
    done_ = true;
    vision_thread_.join();
    robot_thread_.join();
    camera_->stop();
  }

  void see() {
    set_up(60);
    const auto decoder = depth::FrameDecoder::make(camera_->model()).value();
    std::vector<std::uint16_t> pixels(decoder.pixels());
    while (!done_) {
      const auto lease = camera_->next(100ms);
      if (lease.ok()) {
        const auto report = decoder.run({lease.value().frame().depth, {}}, {pixels, {}});
        news_.write({lease.value().frame().captured_ns, report.valid});
      }
    }
  }

  /// One frame on account of the newest picture; measured once the bus has it.
  void tell(const News& news) {
    hal::CanFrame frame;
    frame.id = kNewsId;
    frame.fd = true;
    frame.size_bytes = 8;
    frame.data[0] = std::byte(news.valid_pixels > 0 ? 1 : 0);
    if (host_bus_->send(frame).ok()) {
      times_.camera_to_bus.add(clock_.now_ns() - news.captured_ns);
    }
  }

  rt::MonotonicClock clock_;
  std::unique_ptr<SocketCanBus> host_bus_ = open_vcan();
  std::unique_ptr<SocketCanBus> robot_bus_ = open_vcan();
  std::unique_ptr<hal::v4l2::V4l2Camera> camera_;
  std::optional<hal::sim::SimRobot> robot_;
  rt::LatestValue<News> news_;
  rt::CycleTimes times_;
  std::atomic<bool> done_{false};
  std::thread robot_thread_;
  std::thread vision_thread_;
};

void report(const char* what, const rt::Histogram& histogram) {
  std::printf("LATENCY %s count %llu worst_ns %lld\n", what,
              static_cast<unsigned long long>(histogram.count()),
              static_cast<long long>(histogram.max_ns()));
}

TEST_F(LatencyTest, of_the_cycle_and_from_camera_to_bus_is_reported) {
  const auto points = round_weld(kPoints, 1000);
  set_up(80);
  link::Sender sender = link::Sender::make({}).value();
  hal::LinkPort port(*host_bus_);
  rt::Cycle cycle = rt::Cycle::make({}, clock_).value();
  auto progress = link::WeldProgress::kUnderWay;
  wait_for_even_second(clock_);

  for (std::size_t i = 0; i < 3 * kPoints && progress == link::WeldProgress::kUnderWay; ++i) {
    const auto tick = cycle.wait();
    times_.wake_up.add(tick.woke_ns - tick.due_ns);
    progress = link::give_next_order(sender, {7, 1, points, true}, tick.woke_ns);
    port.turn(sender, tick.woke_ns);
    News news;
    if (news_.read(news)) {
      tell(news);
    }
    times_.compute.add(clock_.now_ns() - tick.woke_ns);
  }

  EXPECT_EQ(progress, link::WeldProgress::kDone) << link::name(sender.fault());
  EXPECT_GT(times_.camera_to_bus.count(), 10U);
  report("wake-up", times_.wake_up);
  report("compute", times_.compute);
  report("camera-to-bus", times_.camera_to_bus);
}

}  // namespace
}  // namespace dseam::test
