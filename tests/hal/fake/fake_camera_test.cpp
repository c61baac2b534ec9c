// SPDX-License-Identifier: Apache-2.0
#include "dseam/hal/fake/fake_camera.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "dseam/hal/camera/camera_monitor.hpp"
#include "dseam/hal/fake/manual_clock.hpp"

namespace dseam::hal::fake {
namespace {

constexpr std::int64_t kPeriodNs = 33'000'000;

/// A camera, its clock and a monitor, in virtual time.
class Bench {
 public:
  Bench() { (void)camera_.start(FrameMode::kEvery); }

  /// One period: what came of it.
  CameraVerdict step() {
    const auto lease = camera_.next(std::chrono::nanoseconds(kPeriodNs));
    const std::int64_t now_ns = static_cast<Clock&>(clock_).now_ns();
    return lease.ok() ? monitor_.on_frame(lease.value().frame(), now_ns)
                      : monitor_.on_absence(lease.error(), now_ns);
  }
  void play(std::span<const FaultStep> steps) {
    camera_.play(steps);
    for (int i = 0; i < 4000 && !camera_.script_done(); ++i) {
      (void)step();
    }
  }
  FakeCamera& camera() { return camera_; }
  CameraMonitor& monitor() { return monitor_; }

 private:
  static depth::DepthModel model() {
    return {.intrinsics = {.width = 8, .height = 6, .fx = 10, .fy = 10}};
  }

  std::vector<std::byte> depth_ = std::vector<std::byte>(8 * 6 * 2, std::byte{1});
  std::vector<std::byte> pool_ = std::vector<std::byte>(FakeCamera::pool_bytes(model(), 4));
  ManualClock clock_{1'000'000'000};
  FakeCamera camera_{
      {.model = model(), .period_ns = kPeriodNs, .depth = depth_, .gray = {}, .pool = pool_},
      clock_};
  CameraMonitor monitor_{{.period_ns = kPeriodNs}};
};

struct FaultCase {
  const char* name;
  DeviceFault fault;
  std::uint32_t count;
  CameraVerdict verdict;                 ///< What the monitor must say at least once.
  std::uint64_t CameraHealth::*counter;  ///< What the camera must count, if anything.
};

class FakeCameraFault : public ::testing::TestWithParam<FaultCase> {};

// Cases 1 to 9 of the catalogue of faults, but for garbage (4): each ends in a named verdict or a
// counter.
TEST_P(FakeCameraFault, ends_in_a_named_verdict_and_good_frames_follow) {
  Bench bench;
  const FaultCase& row = GetParam();
  const std::array<FaultStep, 3> script{
      {{DeviceFault::kNone, 3}, {row.fault, row.count}, {DeviceFault::kNone, 3}}};

  bench.play(script);

  EXPECT_TRUE(bench.camera().script_done());
  EXPECT_GE(bench.monitor().counted(row.verdict), 1U);
  EXPECT_TRUE(row.counter == nullptr || bench.camera().health().*row.counter > 0);
  EXPECT_GE(bench.monitor().counted(CameraVerdict::kGood), 4U);
  EXPECT_EQ(bench.camera().num_lent(), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Catalogue, FakeCameraFault,
    ::testing::Values(
        FaultCase{"off", DeviceFault::kOff, 5, CameraVerdict::kSilent, nullptr},
        FaultCase{"lost", DeviceFault::kLost, 5, CameraVerdict::kSilent, &CameraHealth::lost},
        FaultCase{"stuck", DeviceFault::kStuck, 5, CameraVerdict::kStuck, nullptr},
        FaultCase{"wrong", DeviceFault::kWrong, 5, CameraVerdict::kSilent, &CameraHealth::damaged},
        FaultCase{"truncated", DeviceFault::kTruncated, 5, CameraVerdict::kSilent,
                  &CameraHealth::damaged},
        FaultCase{"delayed", DeviceFault::kDelayed, 5, CameraVerdict::kStale, nullptr},
        FaultCase{"slow", DeviceFault::kSlow, 5, CameraVerdict::kSilent, nullptr},
        FaultCase{"intermittent", DeviceFault::kIntermittent, 6, CameraVerdict::kWaiting, nullptr},
        FaultCase{"unplugged", DeviceFault::kUnplugged, 5, CameraVerdict::kLost,
                  &CameraHealth::reconnects},
        FaultCase{"clock_jump", DeviceFault::kClockJump, 1, CameraVerdict::kClockJump, nullptr}),
    [](const auto& row) { return std::string(row.param.name); });

/// Neither stamps nor size give it away: what is made of it later has to (the seam's confidence).
TEST(FakeCamera, garbage_is_a_whole_frame_with_another_content) {
  Bench bench;
  constexpr std::array<FaultStep, 2> kScript{{{DeviceFault::kNone, 1}, {DeviceFault::kGarbage, 1}}};
  bench.camera().play(kScript);
  std::vector<std::vector<std::byte>> seen;

  for (int i = 0; i < 2; ++i) {
    const auto lease = bench.camera().next(std::chrono::nanoseconds(kPeriodNs));
    ASSERT_TRUE(lease.ok());
    seen.emplace_back(lease.value().frame().depth.begin(), lease.value().frame().depth.end());
  }

  EXPECT_EQ(seen[0].size(), seen[1].size());
  EXPECT_NE(seen[0], seen[1]);
}

TEST(FakeCamera, twelve_thousand_random_faults_leave_nothing_lent_and_the_counts_add_up) {
  Pcg32 random(11);
  std::vector<FaultStep> script;
  std::uint64_t frames = 0;
  for (int i = 0; i < 4000; ++i) {
    script.push_back({static_cast<DeviceFault>(1 + random.below(11)), 1 + random.below(5)});
    frames += script.back().count;
  }
  Bench bench;

  bench.camera().play(script);
  for (std::uint64_t i = 0; i < 8 * frames && !bench.camera().script_done(); ++i) {
    (void)bench.step();
  }

  ASSERT_GE(frames, 10'000U);
  EXPECT_TRUE(bench.camera().script_done());
  EXPECT_EQ(bench.camera().num_lent(), 0U);
  const CameraHealth health = bench.camera().health();
  EXPECT_LE(health.delivered + health.damaged + health.lost + health.underruns, frames);
  EXPECT_GT(health.damaged, 0U);
  EXPECT_GT(health.reconnects, 0U);
}

TEST(FakeCamera, a_consumer_that_is_away_meets_underruns_not_overwritten_frames) {
  Bench bench;
  constexpr std::array<FaultStep, 1> kGood{{{DeviceFault::kNone, 100}}};
  bench.camera().play(kGood);
  std::vector<FrameLease> hoard;

  for (int i = 0; i < 8; ++i) {
    auto lease = bench.camera().next(std::chrono::nanoseconds(kPeriodNs));
    if (lease.ok()) {
      hoard.push_back(std::move(lease.value()));
    }
  }

  EXPECT_EQ(hoard.size(), 4U);
  EXPECT_GE(bench.camera().health().underruns, 3U);
}

}  // namespace
}  // namespace dseam::hal::fake
