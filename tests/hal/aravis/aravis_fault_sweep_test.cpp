// SPDX-License-Identifier: Apache-2.0
// Every call that the real backend makes into Aravis fails once, and from there on for ever.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <iterator>
#include <thread>

#include "dseam/hal/aravis/aravis_camera.hpp"
#include "hal/aravis/fake/faulty_aravis.hpp"

namespace dseam::hal::aravis {
namespace {

using namespace std::chrono_literals;
using test::FakeScan3d;
using test::FaultyAravis;

constexpr ArvDeviceError kErrors[] = {
    ARV_DEVICE_ERROR_WRONG_FEATURE,     ARV_DEVICE_ERROR_FEATURE_NOT_FOUND,
    ARV_DEVICE_ERROR_NOT_CONNECTED,     ARV_DEVICE_ERROR_PROTOCOL_ERROR,
    ARV_DEVICE_ERROR_TRANSFER_ERROR,    ARV_DEVICE_ERROR_TIMEOUT,
    ARV_DEVICE_ERROR_NOT_FOUND,         ARV_DEVICE_ERROR_INVALID_PARAMETER,
    ARV_DEVICE_ERROR_GENICAM_NOT_FOUND, ARV_DEVICE_ERROR_NO_STREAM_CHANNEL,
    ARV_DEVICE_ERROR_NOT_CONTROLLER,    ARV_DEVICE_ERROR_UNKNOWN};

constexpr ArvBufferStatus kBadStatuses[] = {
    ARV_BUFFER_STATUS_UNKNOWN,         ARV_BUFFER_STATUS_CLEARED,
    ARV_BUFFER_STATUS_TIMEOUT,         ARV_BUFFER_STATUS_MISSING_PACKETS,
    ARV_BUFFER_STATUS_WRONG_PACKET_ID, ARV_BUFFER_STATUS_SIZE_MISMATCH,
    ARV_BUFFER_STATUS_FILLING,         ARV_BUFFER_STATUS_ABORTED};

FakeScan3d small_camera() {
  FakeScan3d scan;
  scan.width = 32;
  scan.height = 24;
  return scan;
}

AravisConfig config() {
  AravisConfig config;
  config.id = FaultyAravis::kCameraId;
  config.pixel_format = "Depth";
  config.frame_rate_hz = 1000.0;
  config.num_buffers = 4;
  config.first_retry = 1ms;
  return config;
}

/// What became of one session in which a call failed.
struct Outcome {
  bool opened = false;
  bool named = false;  ///< A refusal came with words.
  bool true_model = true;
  bool told = false;  ///< After it was opened: a frame, an error, a state or a counter.
  bool well = false;  ///< In the end frames came, or start() said that there are none.
};

bool tells(const AravisCamera& camera) {
  const CameraHealth health = camera.health();
  return camera.state() == AravisState::kLost || camera.state() == AravisState::kStalled ||
         health.damaged + health.reconnects + health.lost + health.underruns > 0;
}

/// Whether a frame comes in time; what comes instead of one counts as told, and is waited for.
bool takes_frame(AravisCamera& camera, std::chrono::milliseconds patience, Outcome& outcome) {
  constexpr auto kUntilTold = 3s;
  const auto begin = std::chrono::steady_clock::now();
  bool came = false;
  while (!came &&
         std::chrono::steady_clock::now() < begin + (outcome.told ? patience : kUntilTold)) {
    const auto lease = camera.next(2ms);
    came = lease.ok();
    outcome.told = outcome.told || came || lease.error() == Errc::kDisconnected || tells(camera);
    if (!came && lease.error() == Errc::kUnavailable) {
      break;
    }
  }
  return came;
}

/// A whole life: open, start, frames, a lost connection, stop, start again, frames, close.
Outcome live(FaultyAravis& sys, std::chrono::milliseconds patience) {
  std::string problem;
  auto opened = AravisCamera::open(config(), sys, problem);
  Outcome outcome;
  outcome.opened = opened.ok();
  outcome.named = !problem.empty();
  if (!opened.ok()) {
    return outcome;
  }
  AravisCamera& camera = *opened.value();
  const depth::DepthModel& model = camera.model();
  outcome.true_model = model.scale[2] == 0.05 && model.offset[2] == 100.0 &&
                       model.scale[0] == 0.1 && model.intrinsics.fx == 512.0 &&
                       model.intrinsics.width == 32U && model.mm_per_unit == 1.0;
  for (const FrameMode mode : {FrameMode::kEvery, FrameMode::kLatest}) {
    const bool started = camera.start(mode).ok();
    outcome.told = outcome.told || !started;
    outcome.well = !started || takes_frame(camera, patience, outcome);
    if (started && outcome.well && mode == FrameMode::kEvery) {
      sys.lose_control();
      std::this_thread::sleep_for(6ms);
      outcome.well = takes_frame(camera, patience, outcome);
    }
    camera.stop();
  }
  return outcome;
}

std::uint64_t calls_of_a_life() {
  FaultyAravis sys(small_camera());
  const Outcome outcome = live(sys, 2s);
  EXPECT_TRUE(outcome.well);
  return sys.num_calls();
}

/// Entries of a folder of /proc: this process's threads, or its descriptors.
std::ptrdiff_t entries_of(const char* folder) {
  const std::filesystem::directory_iterator entries(folder);
  return std::distance(begin(entries), end(entries));
}

class AravisFaultSweep : public ::testing::TestWithParam<ArvDeviceError> {
 protected:
  void sweep(bool for_ever, std::chrono::milliseconds patience) {
    const std::uint64_t calls = calls_of_a_life();
    const std::ptrdiff_t threads = entries_of("/proc/self/task");
    const std::ptrdiff_t descriptors = entries_of("/proc/self/fd");
    std::uint64_t injected = 0;
    for (std::uint64_t n = 0; n < calls; ++n) {
      FaultyAravis sys(small_camera());
      sys.fail_call(n, GetParam(), for_ever);

      const Outcome outcome = live(sys, patience);

      injected += sys.num_injected();
      ASSERT_TRUE(outcome.opened || outcome.named) << "call " << n;
      ASSERT_TRUE(outcome.true_model) << "call " << n;
      ASSERT_TRUE(!outcome.opened || outcome.told) << "call " << n;
      ASSERT_TRUE(!outcome.opened || outcome.well || for_ever) << "call " << n;
      ASSERT_EQ(sys.num_alive(), 0) << "call " << n;
    }
    std::cout << injected << " faults in lives of " << calls << " calls\n";
    EXPECT_GE(injected, calls / 2);
    EXPECT_EQ(entries_of("/proc/self/task"), threads);
    EXPECT_EQ(entries_of("/proc/self/fd"), descriptors);
  }
};

TEST_P(AravisFaultSweep, one_failed_call_is_survived_or_named_and_nothing_leaks) {
  sweep(false, 2s);
}

TEST_P(AravisFaultSweep, calls_that_fail_for_ever_end_in_a_named_state_and_nothing_leaks) {
  sweep(true, 10ms);
}

INSTANTIATE_TEST_SUITE_P(Errors, AravisFaultSweep, ::testing::ValuesIn(kErrors));

class AravisBadFrames : public ::testing::TestWithParam<ArvBufferStatus> {};

TEST_P(AravisBadFrames, a_frame_of_any_bad_status_is_counted_and_never_delivered) {
  FaultyAravis sys(small_camera());
  sys.spoil_frame(1, GetParam(), true);
  std::string problem;
  auto opened = AravisCamera::open(config(), sys, problem);
  ASSERT_TRUE(opened.ok()) << problem;
  AravisCamera& camera = *opened.value();
  ASSERT_TRUE(camera.start(FrameMode::kEvery).ok());

  int delivered = 0;
  for (int i = 0; i < 200 && camera.health().damaged < 100; ++i) {
    delivered += camera.next(10ms).ok() ? 1 : 0;
  }

  EXPECT_EQ(delivered, 1);
  EXPECT_GE(camera.health().damaged, 100U);
}

INSTANTIATE_TEST_SUITE_P(Statuses, AravisBadFrames, ::testing::ValuesIn(kBadStatuses));

}  // namespace
}  // namespace dseam::hal::aravis
