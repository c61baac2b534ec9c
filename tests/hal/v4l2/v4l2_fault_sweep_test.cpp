// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cerrno>

#include "dseam/hal/v4l2/v4l2_camera.hpp"
#include "hal/v4l2/fake_v4l2_sys.hpp"

namespace dseam::hal::v4l2 {
namespace {

using namespace std::chrono_literals;
using test::FakeV4l2Sys;

constexpr int kErrors[] = {EIO,   ENODEV, ENXIO,  EBUSY, ENOMEM, EINVAL, EAGAIN,
                           EINTR, EPIPE,  EACCES, EPERM, ENOTTY, EBADF,  EFAULT};

V4l2Config config() {
  V4l2Config config;
  config.device = "/dev/video0";
  config.model.intrinsics = {.fx = 50.0, .fy = 50.0};
  config.num_buffers = 3;
  config.first_retry = 1ms;
  config.lost_after = 3ms;
  return config;
}

/// What became of one session in which a call failed.
struct Outcome {
  bool opened = false;
  bool named = false;  ///< A refusal came with words.
  /// After it was opened: frames, or an error from start() or next(), or a counter or a state.
  bool told = false;
  int torn_frames = 0;  ///< Frames whose bytes do not belong together.
};

/// A whole life: open, start, frames with one on loan, stop, start again, close.
Outcome live(FakeV4l2Sys& sys) {
  std::string problem;
  auto opened = V4l2Camera::open(config(), sys, problem);
  Outcome outcome{.opened = opened.ok(), .named = !problem.empty()};
  if (!opened.ok()) {
    return outcome;
  }
  V4l2Camera& camera = *opened.value();
  for (const FrameMode mode : {FrameMode::kEvery, FrameMode::kLatest}) {
    const bool started = camera.start(mode).ok();
    outcome.told = outcome.told || !started;
    FrameLease held;
    for (int i = 0; i < 4; ++i) {
      auto lease = camera.next(2ms);
      if (lease.ok()) {
        const auto bytes = lease.value().frame().depth;
        outcome.torn_frames += bytes.front() != bytes.back() ? 1 : 0;
        held = std::move(lease.value());
      }
      outcome.told = outcome.told || lease.ok() || lease.error() == Errc::kDisconnected;
    }
    outcome.told = outcome.told || camera.state() == V4l2State::kLost;
    camera.stop();
  }
  const CameraHealth health = camera.health();
  outcome.told = outcome.told || health.damaged + health.reconnects + health.lost > 0;
  return outcome;
}

class V4l2FaultSweep : public ::testing::TestWithParam<bool> {};

TEST_P(V4l2FaultSweep, every_call_may_fail_with_every_error_and_nothing_leaks) {
  FakeV4l2Sys untouched;
  ASSERT_TRUE(live(untouched).opened);
  const std::uint64_t calls = untouched.num_calls();
  std::uint64_t injected = 0;

  for (const int error : kErrors) {
    for (std::uint64_t n = 0; n < calls; ++n) {
      FakeV4l2Sys sys;
      sys.fail_call(n, error, GetParam());

      const Outcome outcome = live(sys);

      injected += sys.num_injected();
      ASSERT_TRUE(outcome.opened || outcome.named) << "call " << n << " errno " << error;
      ASSERT_TRUE(!outcome.opened || outcome.told) << "call " << n << " errno " << error;
      ASSERT_EQ(outcome.torn_frames, 0) << "call " << n << " errno " << error;
      ASSERT_EQ(sys.num_open(), 0U) << "call " << n << " errno " << error;
      ASSERT_EQ(sys.num_mapped(), 0U) << "call " << n << " errno " << error;
    }
  }

  RecordProperty("calls", static_cast<int>(calls));
  RecordProperty("injected", static_cast<int>(injected));
  EXPECT_GE(injected, std::size(kErrors) * calls * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Once, V4l2FaultSweep, ::testing::Values(false));
INSTANTIATE_TEST_SUITE_P(ForEver, V4l2FaultSweep, ::testing::Values(true));

}  // namespace
}  // namespace dseam::hal::v4l2
